#include "libcore/resampling/cache_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

constexpr std::uint64_t kPathsPerChunk = 64;
constexpr std::size_t kPointsPerChunk = 256;

/// Calls body(i) for i in [0, n), in tasks of kPointsPerChunk.
template <class Body>
void forEachPoint(const ThreadPool& threads, std::size_t n, const Body& body) {
    threads.forEach((n + kPointsPerChunk - 1) / kPointsPerChunk, [&](std::size_t chunk) {
        const std::size_t begin = chunk * kPointsPerChunk;
        for (std::size_t i = begin; i < std::min(n, begin + kPointsPerChunk); ++i) {
            body(std::uint32_t(i));
        }
    });
}

/// About the squared distance of neighbours, if the points were spread over a surface of
/// their box's size.
double typicalSpacing2(std::span<const Vec3> positions) {
    if (positions.empty()) return 0.0;
    Vec3 low = positions[0], high = positions[0];
    for (const Vec3 p : positions) {
        low = min(low, p);
        high = max(high, p);
    }
    return lengthSquared(Vec3d(high) - Vec3d(low)) / double(positions.size());
}

}  // namespace

CachePoints::CachePoints(IterationContext& context, double density, int neighbours,
                         std::uint32_t generation) {
    const auto paths =
        std::max<std::uint64_t>(1, std::uint64_t(std::ceil(density * double(context.filmPixels))));
    struct Chunk {
        std::vector<PathVertex> vertices;
        RayTally tally;
    };
    std::vector<Chunk> chunks((paths + kPathsPerChunk - 1) / kPathsPerChunk);
    context.threads.forEach(chunks.size(), [&](std::size_t c) {
        std::vector<PathVertex> path;
        const std::uint64_t begin = c * kPathsPerChunk;
        for (std::uint64_t i = begin; i < std::min(paths, begin + kPathsPerChunk); ++i) {
            Rng rng(context.seed, generation, StreamKind::CachePath, i);
            context.space.traceEye(rng, chunks[c].tally, path);
            chunks[c].vertices.insert(chunks[c].vertices.end(), path.begin(), path.end());
        }
    });
    std::vector<Vec3> positions, sides;
    for (const Chunk& chunk : chunks) {
        context.statistics.add(chunk.tally);
        for (const PathVertex& v : chunk.vertices) {
            if (v.kind == VertexKind::Surface && v.connectable()) {
                points_.push_back(std::uint32_t(vertices_.size()));
                positions.push_back(v.position);
                sides.push_back(scatteringSide(v));
            }
            vertices_.push_back(v);
        }
    }
    const double spacing2 = typicalSpacing2(positions);
    // Points that face away count as twice the spacing off: those behind a thin wall
    // are passed over.
    nearest_ = NearestPoints(std::move(positions), std::move(sides), float(std::sqrt(spacing2)));

    // One neighbour beyond N_c says how far the point's region reaches where N_c is 1.
    const std::size_t asked = std::min(size(), std::size_t(neighbours) + 1);
    perPoint_ = std::min(size(), std::size_t(neighbours));
    around_.resize(size() * perPoint_);
    limit_.resize(size());
    forEachPoint(context.threads, size(), [&](std::uint32_t i) {
        std::vector<std::uint32_t> found(asked);
        nearest_.find(position(i), side(i), found);
        // Where points coincide, another one may come first.
        const auto self = std::find(found.begin(), found.end(), i);
        std::rotate(found.begin(), self == found.end() ? self - 1 : self,
                    self == found.end() ? self : self + 1);
        found[0] = i;
        std::copy_n(found.begin(), perPoint_, around_.begin() + std::ptrdiff_t(i * perPoint_));
        double d2 = 0.0;
        for (const std::uint32_t j : found) {
            d2 = std::max(d2, lengthSquared(Vec3d(position(j)) - Vec3d(position(i))));
        }
        // Where all neighbours coincide, the mean spacing stands in. Where all points do, any
        // finite limit will do.
        if (!(d2 > 0.0)) d2 = spacing2;
        limit_[i] = d2 > 0.0 ? 1.0 / d2 : double(std::numeric_limits<float>::max());
    });
}

void CachePoints::labelAsEye(std::span<PathVertex> walk) const {
    for (PathVertex& v : walk) {
        const bool served = v.kind == VertexKind::Surface && v.connectable();
        if (served && v.asEye == kNone) v.asEye = nearest(v);
    }
}

std::uint32_t CachePoints::nearest(const PathVertex& vertex) const {
    std::uint32_t found = kNone;
    nearest_.find(vertex.position, scatteringSide(vertex), {&found, 1});
    return found;
}

double CachePoints::trustedGeometry(std::uint32_t point, const PathVertex& light,
                                    double geometry) const {
    const PathVertex& at = vertices_[points_[point]];
    const Edge edge = edgeBetween(light, at);
    const bool behind = leadsBehind(at, -edge.direction) &&
                        isBlack(at.bsdf.evaluate(at.toPrevious, -edge.direction).f);
    const double here = behind ? 0.0 : double(edge.geometry);
    // Never zero for a path that carries something: it may have no other strategy (theory.md,
    // "Cache points").
    return limited(point, light, std::clamp(here, 1e-4 * geometry, geometry));
}

std::uint64_t CachePoints::bytes() const {
    return vertices_.size() * sizeof(PathVertex) +
           size() * (sizeof(Vec3) + sizeof(std::uint32_t) * (2 + perPoint_) + sizeof(double));
}

void EarlierValues::add(CachePoints points, std::vector<double> values) {
    if (points.empty()) return;
    if (history_.size() == sets_) history_.pop_front();
    history_.push_back({std::move(points).takeNearest(), std::move(values)});
}

std::vector<double> EarlierValues::at(const CachePoints& points, const ThreadPool& threads) const {
    std::vector<double> result(points.size() * columns_, 0.0);
    forEachPoint(threads, points.size(), [&](std::uint32_t i) {
        std::vector<std::uint32_t> found(count_);
        for (const Set& set : history_) {
            const std::size_t n = set.nearest.find(points.position(i), points.side(i), found);
            const double share = 1.0 / (double(n) * double(history_.size()));
            for (std::size_t j = 0; j < n; ++j) {
                for (std::size_t k = 0; k < columns_; ++k) {
                    result[i * columns_ + k] += share * set.values[found[j] * columns_ + k];
                }
            }
        }
    });
    return result;
}

}  // namespace lacuna

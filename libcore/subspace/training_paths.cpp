#include "libcore/subspace/training_paths.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

constexpr std::size_t kPathsPerTask = 8192;

}  // namespace

void TrainingPaths::add(FullPath& path, const TechniqueCounts& counts, const LightCells& cells,
                        float contribution, std::uint32_t pixel) {
    const int k = path.edges;
    if (!(contribution > 0.0f) || !std::isfinite(contribution) || k < 2) return;
    path.fillLightThroughputs(counts.rouletteDepth);
    const std::uint64_t first = vertices_.size();
    bool any = false;
    for (int i = 0; i <= k; ++i) {
        const PathVertex& x = *path.vertex[std::size_t(i)];
        Vertex v{x.position, x.ng, 0.0f};
        const int t = k - i;  // s = i + 1
        if (t >= 2) {
            const double w = misWeight(path, counts, t);
            const auto strength = float(w * double(mean(path.beta[std::size_t(i)])));
            if (strength > 0.0f && std::isfinite(strength)) {
                v.strength = strength;
                any = true;
            }
        }
        vertices_.push_back(v);
    }
    if (!any) {
        vertices_.resize(first);
        return;
    }
    const PathVertex& source = *path.vertex[0];
    const double fixed = misWeight(path, counts, 1) + misWeight(path, counts, k + 1);
    paths_.push_back({first, pixel, cells.cellOf(source), contribution, float(fixed),
                      std::uint16_t(k), source.infinite()});
}

void TrainingPaths::append(const TrainingPaths& other, std::size_t index) {
    Path p = other.paths_[index];
    const auto begin = other.vertices_.begin() + std::ptrdiff_t(p.firstVertex);
    p.firstVertex = vertices_.size();
    vertices_.insert(vertices_.end(), begin, begin + p.edges + 1);
    paths_.push_back(p);
}

void TrainingPaths::relate(const PixelScale& scale) {
    for (Path& p : paths_) p.contribution = float(double(p.contribution) / scale.of(p.pixel));
}

float TrainingPaths::outlierLimit() const {
    std::vector<float> contributions;
    for (const Path& p : paths_) contributions.push_back(p.contribution);
    return lacuna::outlierLimit(contributions);
}

std::size_t TrainingPaths::lowerTo(float limit) {
    std::size_t lowered = 0;
    for (Path& p : paths_) {
        if (!(p.contribution > limit)) continue;
        p.contribution = limit;
        ++lowered;
    }
    return lowered;
}

SubpathEnd TrainingPaths::lightEnd(const Path& p, int s) const {
    const Vertex &x = vertex(p, s - 1), &before = vertex(p, s - 2);
    return subpathEnd(x.position, x.normal, before.position, s == 2 && p.infiniteSource);
}

SubpathEnd TrainingPaths::eyeEnd(const Path& p, int s) const {
    const Vertex& x = vertex(p, s);
    return subpathEnd(x.position, x.normal, vertex(p, s + 1).position, false);
}

std::uint64_t TrainingPaths::bytes() const {
    return paths_.size() * sizeof(Path) + vertices_.size() * sizeof(Vertex);
}

GammaData gammaData(const TrainingPaths& paths, const Subspaces& subspaces, int picks,
                    const ThreadPool& pool) {
    const double unseen = unseenQ(subspaces.q, subspaces.lightPaths);
    std::vector<GammaData> parts((paths.size() + kPathsPerTask - 1) / kPathsPerTask);
    pool.forEach(parts.size(), [&](std::size_t task) {
        GammaData& data = parts[task];
        const std::size_t begin = task * kPathsPerTask;
        for (std::size_t n = begin; n < std::min(paths.size(), begin + kPathsPerTask); ++n) {
            const TrainingPaths::Path& p = paths.path(n);
            for (int s = 1; s < int(p.edges); ++s) {
                const double strength = double(paths.strength(p, s));
                if (!(strength > 0.0)) continue;
                const std::uint32_t i =
                    s == 1 ? p.lightCell : subspaces.lightTree(paths.lightEnd(p, s));
                const std::uint32_t j = subspaces.eyeTree(paths.eyeEnd(p, s));
                const double q = subspaces.q[i] > 0.0 ? subspaces.q[i] : unseen;
                data.entries.push_back({i, j, float(picks * strength / q)});
            }
            data.endPath(p.contribution, p.fixed);
        }
    });
    GammaData all;
    all.lightCount = subspaces.lightCount;
    all.eyeCount = subspaces.eyeCount;
    for (const GammaData& part : parts) {
        const std::uint64_t before = all.entries.size();
        all.entries.insert(all.entries.end(), part.entries.begin(), part.entries.end());
        all.contribution.insert(all.contribution.end(), part.contribution.begin(),
                                part.contribution.end());
        all.fixed.insert(all.fixed.end(), part.fixed.begin(), part.fixed.end());
        for (std::size_t p = 1; p < part.begin.size(); ++p) {
            all.begin.push_back(before + part.begin[p]);
        }
    }
    return all;
}

}  // namespace lacuna

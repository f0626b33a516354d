// (theory.md, "Nodes")
#include "libcore/resampling/node_pmfs.h"

#include <algorithm>

#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

constexpr std::uint64_t kCountingPaths = 16384, kCountingPathsPerTask = 256;
constexpr std::size_t kVerticesPerTask = 512;
constexpr double kNearest = 0.1;  // least distance of a light vertex, in radii of the ball

}  // namespace

bool NodePmfs::Options::uses(Distribution d) const {
    switch (d) {
        case kSeen:
            return set == Set::Vuc || set == Set::Vc;
        case kUnseen:
            return set == Set::Vuc || set == Set::Uc;
        default:
            return true;
    }
}

std::uint32_t NodePmfs::nodeOf(const PathVertex& eye, const Vec3& towards) const {
    if (!skeleton_) return NodeMap::kNone;
    const Vec3 side = dot(eye.ng, towards) < 0.0f ? -eye.ng : eye.ng;
    return skeleton_->map.at(Vec3d(eye.position), Vec3d(side));
}

double NodePmfs::weight(std::uint32_t node, const PathVertex& y, double beta) const {
    if (y.infinite()) return beta;
    const SkeletonNode& n = skeleton_->nodes[node];
    const double d2 = lengthSquared(Vec3d(y.position) - n.position);
    const double least = kNearest * n.radius;
    return beta / std::max({d2, least * least, 1e-30});
}

void NodePmfs::prepare(const VerticesByLength& vertices, IterationContext& context) {
    if (!counted_) {
        accept(context);
        if (options_.sight && options_.uses(kSeen)) lookAround(context);
        counted_ = true;
    }
    weigh(vertices, context);
    PhaseTimer timer(context.statistics, "node distributions");
    const std::size_t n = vertices.size();
    lengths_ = std::size_t(vertices.lengths()) + 1;
    pmfs_.assign(accepted_.size() * lengths_, {});
    const std::vector<double> ones(n, 1.0), none(n, 0.0);
    context.threads.forEach(pmfs_.size(), [&](std::size_t i) {
        const std::size_t slot = i / lengths_, s = i % lengths_;
        if (s == 0) return;
        const std::size_t from = vertices.begin(int(s)), count = vertices.count(int(s));
        const auto part = [&](Distribution d, const std::vector<double>& all, std::size_t begin) {
            return options_.uses(d) ? std::span(all).subspan(begin, count)
                                    : std::span(none).first(count);
        };
        const std::span<const double> targets[kDistributions] = {
            part(kSeen, seen_, slot * n + from), part(kUnseen, unseen_, slot * n + from),
            part(kUniform, ones, from)};
        pmfs_[i] = CombinedPmf(targets);
    });
    context.statistics.hold("distribution bytes", bytesOf(pmfs_));
    context.statistics.hold("nodes", slot_.size());
    context.statistics.hold("nodes with distributions", accepted_.size());
}

/// Fills seen_ and unseen_ for all vertices.
void NodePmfs::weigh(const VerticesByLength& vertices, IterationContext& context) {
    PhaseTimer timer(context.statistics, "node visibility");
    const std::size_t n = vertices.size();
    seen_.assign(accepted_.size() * n, 0.0);
    unseen_.assign(accepted_.size() * n, 0.0);
    const std::size_t tasksPerNode = (n + kVerticesPerTask - 1) / kVerticesPerTask;
    std::vector<RayTally> tallies(accepted_.size() * tasksPerNode);
    context.threads.forEach(tallies.size(), [&](std::size_t task) {
        const std::size_t slot = task / tasksPerNode;
        const std::size_t first = task % tasksPerNode * kVerticesPerTask;
        const std::uint32_t node = accepted_[slot];
        PathVertex at;
        at.kind = VertexKind::Lens;  // a point without a surface
        at.position = Vec3(skeleton_->nodes[node].position);
        for (std::size_t i = first; i < std::min(n, first + kVerticesPerTask); ++i) {
            const PathVertex& y = vertices.prefix(i).back();
            const double w = weight(node, y, double(mean(y.throughput)));
            unseen_[slot * n + i] = w;
            if (w > 0.0 && options_.uses(kSeen) && context.space.visible(y, at, tallies[task])) {
                seen_[slot * n + i] = w;
            }
        }
    });
    for (const RayTally& t : tallies) context.statistics.add(t);
}

/// Finds the nodes that are worth pmfs: those that many eye vertices are mapped to.
void NodePmfs::accept(IterationContext& context) {
    slot_.assign(nodes(), kNone);
    if (nodes() == 0) return;
    const std::vector<std::uint64_t> hits = countEyeVertices(context);
    std::uint64_t all = 0;
    for (const std::uint64_t h : hits) all += h;
    for (std::uint32_t n = 0; n < nodes(); ++n) {
        if (double(hits[n]) * double(nodes()) <= options_.acceptance * double(all)) continue;
        slot_[n] = std::uint32_t(accepted_.size());
        accepted_.push_back(n);
    }
}

std::vector<std::uint64_t> NodePmfs::countEyeVertices(IterationContext& context) const {
    constexpr std::uint64_t kTasks = kCountingPaths / kCountingPathsPerTask;
    std::vector<std::vector<std::uint32_t>> counts(kTasks);
    std::vector<RayTally> tallies(kTasks);
    context.threads.forEach(kTasks, [&](std::size_t task) {
        counts[task].assign(nodes(), 0);
        std::vector<PathVertex> path;
        for (std::uint64_t i = 0; i < kCountingPathsPerTask; ++i) {
            Rng rng(context.seed, 0, StreamKind::CachePath, task * kCountingPathsPerTask + i);
            context.space.traceEye(rng, tallies[task], path);
            for (const PathVertex& v : path) {
                if (v.kind != VertexKind::Surface || !v.connectable()) continue;
                const std::uint32_t node = nodeOf(v, v.toPrevious);
                if (node < nodes()) ++counts[task][node];
            }
        }
    });
    for (const RayTally& t : tallies) context.statistics.add(t);
    std::vector<std::uint64_t> hits(nodes(), 0);
    for (const auto& part : counts) {
        for (std::size_t n = 0; n < nodes(); ++n) hits[n] += part[n];
    }
    return hits;
}

/// Makes the sight maps of the accepted nodes, which stay the same for the whole render.
void NodePmfs::lookAround(IterationContext& context) {
    PhaseTimer timer(context.statistics, "node sight");
    sight_.resize(accepted_.size());
    std::vector<RayTally> tallies(accepted_.size());
    context.threads.forEach(accepted_.size(), [&](std::size_t slot) {
        const Vec3 position(skeleton_->nodes[accepted_[slot]].position);
        sight_[slot] = SightMap(position, context.space, tallies[slot]);
    });
    for (const RayTally& t : tallies) context.statistics.add(t);
    std::uint64_t bytes = 0;
    for (const SightMap& map : sight_) bytes += map.bytes();
    context.statistics.hold("sight map bytes", bytes);
}

}  // namespace lacuna

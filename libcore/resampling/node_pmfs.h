// Weights of light vertices at the nodes of the empty space's skeleton, and the pmfs built from
// them [Noel15 4]. skelbpt is made of them. (theory.md, "Nodes")
//
//   node      n(z): nearest node by geodesic distance (node_map.h), on the side the eye path is on
//   weight    w_n(y) = mean(beta(y)) / max(|P_n - y|, d)^2, at infinity mean(beta(y))   [eq 5]
//             d: a share of the ball's radius, because a light vertex may lie on the node
//   pmfs      over L_s, per node and s:  V ∝ w_n V(n, y) [eq 6],  U ∝ w_n [eq 7],
//             C = 1 / |L_s| [eq 8]
//             combined by the maximum heuristic, one of them chosen evenly            [4.3]
//   accepted  nodes that more eye vertices are mapped to than `acceptance` times the mean of all
//             nodes [4.4]; the others have no pmfs. Eye subpaths of their own, over the whole film
//             and before the first iteration, count them, not those of earlier iterations: a crop
//             has the same nodes, and the first iteration has pmfs as well
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libcore/bidir/path_space.h"
#include "libcore/resampling/length_pmfs.h"
#include "libcore/resampling/sight_map.h"
#include "libcore/skeleton/node_map.h"

namespace lacuna {

class NodePmfs {
  public:
    enum Distribution : std::uint32_t { kSeen, kUnseen, kUniform, kDistributions };

    struct Options {
        double acceptance = 1.0;
        /// Which of visible (v), unoccluded (u) and uniform (c) there are.
        enum class Set { Vuc, Uc, Vc, C } set = Set::Vuc;
        bool sight = true;  ///< whether weights will ask sees()

        bool uses(Distribution d) const;
    };

    explicit NodePmfs(const Options& options) : options_(options) {}
    void use(std::shared_ptr<const Skeleton> skeleton) { skeleton_ = std::move(skeleton); }

    /// Index of the node of an eye vertex whose predecessor lies along `towards`, which is also the
    /// vertex's label; nodes() or more where there is none.
    std::uint32_t nodeOf(const PathVertex& eye, const Vec3& towards) const;
    std::size_t nodes() const { return skeleton_ ? skeleton_->nodes.size() : 0; }
    /// Place of an accepted node among those that have pmfs; kNone for others.
    std::uint32_t slotOf(std::uint32_t node) const {
        return node < slot_.size() ? slot_[node] : kNone;
    }
    /// The nodes that have pmfs, by slot.
    std::span<const std::uint32_t> accepted() const { return accepted_; }
    /// w_n(y), beta = mean(beta(y)).
    double weight(std::uint32_t node, const PathVertex& y, double beta) const;
    /// V(n, y) as far as the node's map of distances can tell. For beliefs alone.
    bool sees(std::uint32_t slot, const PathVertex& y) const { return sight_[slot].sees(y); }

    /// Makes this iteration's pmfs. The first call finds out which nodes are accepted.
    void prepare(const VerticesByLength& vertices, IterationContext& context);
    /// The pmf over the vertices of length s, by an accepted node's slot.
    const CombinedPmf& pmf(std::uint32_t slot, int s) const {
        return pmfs_[slot * lengths_ + std::size_t(s)];
    }

  private:
    void accept(IterationContext& context);
    std::vector<std::uint64_t> countEyeVertices(IterationContext& context) const;
    void lookAround(IterationContext& context);
    void weigh(const VerticesByLength& vertices, IterationContext& context);

    Options options_;
    std::shared_ptr<const Skeleton> skeleton_;
    bool counted_ = false;
    std::vector<std::uint32_t> slot_;      // by node
    std::vector<std::uint32_t> accepted_;  // nodes, by slot
    std::vector<SightMap> sight_;          // by slot
    std::vector<double> seen_, unseen_;    // weights, by slot and vertex
    std::size_t lengths_ = 1;
    std::vector<CombinedPmf> pmfs_;  // by slot and s
};

}  // namespace lacuna

// A light tree over the light vertices of one pool, and its cuts [Nabata20b 5.1], [Walter05].
// (theory.md, "Light tree")
//
// Two binary trees over disjoint ranges of the same leaves: vertices with a place in the scene by
// position and normal, vertices at infinity by direction. Every node is split in the middle of its
// leaves along the longest axis of its box, so that all indices follow from counts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/method.h"

namespace lacuna {

class LightTree {
  public:
    using Cluster = std::uint32_t;  ///< a node
    /// A vertex drawn from a cluster.
    struct Draw {
        std::uint32_t candidate;  ///< index into the span that the tree was built over
        double pmf;               ///< realised; proportional to mean(beta)            [eq 14]
    };

    LightTree() = default;
    /// Builds the trees over the candidates with power. The others are in no cluster.
    LightTree(const LightPool& pool, std::span<const LightPool::Entry> candidates,
              const ThreadPool& threads);

    /// Number of leaves.
    std::size_t size() const { return order_.size(); }
    /// Sum of mean(beta) over a cluster.
    double power(Cluster c) const { return nodes_[c].power; }
    /// Draws a vertex of the cluster by u in [0, 1). A walk down the tree is exact for any
    /// range of powers.
    Draw draw(Cluster c, double u) const;
    /// Indices of the cluster's candidates.
    std::span<const std::uint32_t> candidates(Cluster c) const {
        return std::span(order_).subspan(nodes_[c].begin, nodes_[c].end - nodes_[c].begin);
    }

    /// Scratch memory of cut().
    struct CutNode {
        double bound;
        std::uint32_t node;
    };
    /// Replaces `cut` by at most `budget` clusters (at least one per tree) that hold every leaf
    /// once: again and again the one with the largest bound on power x G towards `eye` is split.
    void cut(const PathVertex& eye, std::size_t budget, std::vector<CutNode>& heap,
             std::vector<Cluster>& cut) const;

    std::uint64_t bytes() const;

  private:
    struct Leaf {
        Vec3 place;   ///< position, or direction at infinity
        Vec3 normal;  ///< zero where light leaves to all sides
        double power;
        std::uint32_t candidate;
    };
    struct Node {
        double power;
        Vec3 low, high;
        Vec3 axis;           ///< of the cone around all normals; zero: any direction
        float sine, cosine;  ///< of the cone's half angle
        std::uint32_t begin, end;
    };

    void build(std::vector<Leaf>& leaves, std::uint32_t begin, std::uint32_t end,
               const ThreadPool& threads);
    void fillNode(std::uint32_t node, std::span<Leaf> leaves, std::uint32_t begin);
    void joinChildren(std::uint32_t node);
    std::uint32_t rightOf(std::uint32_t node) const {
        return node + 2 * ((nodes_[node].end - nodes_[node].begin) / 2);
    }
    double bound(const Node& node, const PathVertex& eye, Vec3 eyeNormal) const;

    std::vector<std::uint32_t> order_;  // by leaf
    std::vector<Node> nodes_;
    std::uint32_t infinite_ = 0;  // first leaf at infinity
};

}  // namespace lacuna

// A density on the unit square that is constant in each leaf of a tree of halvings.
// (theory.md, "Learned emission")
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lacuna {

/// A point of the unit square.
using SquarePoint = std::array<double, 2>;

/// A binary tree over the unit square. A node halves its part of the square along one axis and
/// stores the probability of the lower half. The default is one leaf: the uniform density.
class SquareDensity {
  public:
    struct Node {
        float lower = 1.0f;      ///< probability of the half with smaller coordinates, in (0, 1)
        std::uint32_t code = 0;  ///< leaf: its number; else kInner, the axis, first child's index
        friend bool operator==(const Node&, const Node&) = default;
    };
    static constexpr std::uint32_t kInner = 0x80000000u, kSecondAxis = 0x40000000u;
    /// Most levels of a tree: as many as two 24-bit coordinates can tell apart.
    static constexpr int kMostLevels = 24;

    SquareDensity() : SquareDensity(std::vector<Node>{Node{}}) {}
    /// The root comes first. The two children of a node are adjacent and come after it. Leaves are
    /// numbered 0, 1, .. in any order. Throws std::invalid_argument for anything else.
    explicit SquareDensity(std::vector<Node> nodes);

    std::span<const Node> nodes() const { return nodes_; }
    std::uint32_t leafCount() const { return leafCount_; }

    /// The leaf that contains a point, and the density there.
    struct Place {
        std::uint32_t leaf;
        double pdf;  ///< density per area of the square
    };
    Place at(SquarePoint p) const {
        SquarePoint low{0.0, 0.0}, size{1.0, 1.0};
        double pdf = 1.0;
        const Node* node = nodes_.data();
        while (node->code & kInner) {
            const std::size_t axis = node->code & kSecondAxis ? 1 : 0;
            size[axis] *= 0.5;
            const bool upper = p[axis] >= low[axis] + size[axis];
            low[axis] += upper ? size[axis] : 0.0;
            pdf *= 2.0 * double(upper ? 1.0f - node->lower : node->lower);
            node = nodes_.data() + (node->code & ~(kInner | kSecondAxis)) + (upper ? 1 : 0);
        }
        return {node->code, pdf};
    }
    /// Maps a uniform point of the square to a point with the density of `at`.
    SquarePoint warp(SquarePoint u) const;

  private:
    std::vector<Node> nodes_;
    std::uint32_t leafCount_ = 1;
};

}  // namespace lacuna

// A node of the lamp tree, for the two files that build and traverse the tree (lamp_tree.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "libcore/scene/lamp_tree.h"

namespace lacuna {

/// Eight children side by side for SIMD: one instruction weighs all of them.
struct alignas(32) LampTree::Node {
    static constexpr std::size_t kWidth = 8;
    using Lanes = std::array<float, kWidth>;

    Lanes x{}, y{}, z{};                        // centre of the box
    Lanes extentX{}, extentY{}, extentZ{};      // half its size
    Lanes radius{};                             // half its diagonal
    Lanes axisX{}, axisY{}, axisZ{};            // axis of the cone
    Lanes sine{}, cosine{};                     // of the cone's half angle
    Lanes fades{}, twoSided{};                  // 1 or 0
    Lanes intensity{};                          // 0: no child
    std::array<std::uint32_t, kWidth> child{};  // 0: a leaf
    std::array<std::uint32_t, kWidth> begin;    // first leaf below it; no child: beyond all leaves

    Node() { begin.fill(~0u); }

    void set(std::size_t i, const Extent& e, std::uint32_t first);
    void weigh(const Viewpoint& from, Lanes& importance) const;
    Shares shares(const Viewpoint& from) const;
    /// The child that contains the leaf.
    std::size_t childOf(std::uint32_t leaf) const {
        std::uint32_t begun = 0;
        for (const std::uint32_t b : begin) begun += b <= leaf ? 1 : 0;
        return begun - 1;
    }
};

/// Weights in proportion to which the children of a node are picked.
struct LampTree::Shares {
    Node::Lanes weights{};
    double sum = 0.0;
    bool dark = false;  ///< no child can send light: they are picked by intensity

    double operator[](std::size_t i) const { return double(weights[i]) / sum; }
};

/// Weights of the choice between the tree and the lights at infinity: that of the tree, and the
/// sum.
struct LampTree::Roots {
    Shares node;  ///< of the root node, if there is one
    double tree = 1.0, sum = 1.0;
    bool even = false;  ///< no light can arrive: all have the same weight
};

/// Bounds of the lights below a node.
struct LampTree::Extent {
    Vec3 low, high;
    ShiningCone cone;
    double intensity = 0.0;  // 0: no lights so far

    void add(const Vec3& l, const Vec3& h, const ShiningCone& c, double i) {
        if (intensity == 0.0) {
            *this = {l, h, c, i};
            return;
        }
        low = min(low, l);
        high = max(high, h);
        cone.add(c);
        intensity += i;
    }
    void add(const PlacedLight& l) { add(l.low, l.high, l.cone, l.intensity); }
    void add(const Extent& e) {
        if (e.intensity > 0.0) add(e.low, e.high, e.cone, e.intensity);
    }
    /// The cost that a split minimises [Conty18 eq 2], with the box's squared diagonal instead of
    /// its surface, which is zero for lights in a row.
    static std::uint32_t split(std::span<PlacedLight> own);
    double cost() const {
        return intensity == 0.0 ? 0.0
                                : intensity * cone.measure() * double(lengthSquared(high - low));
    }
};

}  // namespace lacuna

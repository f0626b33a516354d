// Picks a light for next-event estimation at a point: a tree of lights with boxes and cones
// [Conty18]. Its nodes are weighed by the bound of [Pharr23 12.6.3]; for surfaces, by a typical
// value below the bound. A node has eight children, which are weighed at once. (theory.md, "Lamps
// that are seen")
//
// Lights with a position are the tree's leaves. Lights at infinity stand beside its root and are
// weighed by their irradiance. Those in about the same direction are bundled, because a sun with a
// size consists of many lights. A pick descends along one path, and so does the computation of its
// probability. Both use the same numbers in the same order, so that they agree bit for bit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/scene/sky_sides.h"

namespace lacuna {

/// The point that receives light.
struct Viewpoint {
    Vec3 position;
    Vec3 side;  ///< unit, side from which light must come; zero: any
};

/// The cone of directions of emission.
struct ShiningCone {
    Vec3d axis;             ///< unit
    double angle = 0;       ///< half angle; within it, light may have the full intensity
    bool fades = false;     ///< emits outside too, by the cosine to the cone, like a surface
    bool twoSided = false;  ///< also emits against the axis

    void add(const ShiningCone& other);
    /// Integral of the emission that the cone allows, per intensity [Conty18 eq 1].
    double measure() const;
};

/// A light with a position, or the two halves of a flat lamp, which are consecutive lights.
struct PlacedLight {
    std::uint32_t light;
    Vec3 low, high;
    ShiningCone cone;
    double intensity;  ///< maximum over all directions; positive
    double share = 1;  ///< the first light's share of it; 1: there is no second light
};
/// A light at infinity.
struct DistantLight {
    std::uint32_t light;
    Vec3 direction;     ///< unit, towards the light; zero: from all sides
    double irradiance;  ///< positive, in units of intensity over squared distance
};

class LampTree {
  public:
    LampTree();
    LampTree(LampTree&&) noexcept;
    LampTree& operator=(LampTree&&) noexcept;
    ~LampTree();
    /// `sceneRadius`: positive. `lights`: number of all lights, including those without power. `sky`: irradiance by
    /// side of the light that comes from all sides.
    LampTree(std::vector<PlacedLight> placed, std::span<const DistantLight> distant,
             float sceneRadius, std::size_t lights, SkySides sky = {});

    /// Whether there is more than one leaf or distant light to choose from. (The two halves of one
    /// lamp are one leaf and are picked by power.)
    bool chooses() const { return leaves_.size() + distant_.size() > 1; }

    struct Pick {
        std::uint32_t light;
        double pmf;
        double remapped;  ///< u, rescaled to [0, 1) within the outcome; can be reused
    };
    /// Picks a light with u in [0, 1). Must not be called on an empty tree.
    Pick pick(const Viewpoint& from, double u) const;
    /// Probability of picking the light; zero for lights that are not in the tree.
    double pmf(const Viewpoint& from, std::uint32_t light) const;
    /// The weight of the light alone: about the light that arrives from it, up to a common factor. It is zero only if
    /// no light can arrive.
    double importance(const Viewpoint& from, std::uint32_t light) const;

    std::uint64_t bytes() const;

  private:
    struct Node;
    struct Extent;
    struct Range;
    struct Shares;
    struct Leaf {
        std::uint32_t light;
        double share;  ///< probability of `light`; the rest belongs to the next light
        double shareOf(std::uint32_t l) const { return l == light ? share : 1.0 - share; }
    };
    /// Consecutive lights at infinity in about the same direction; within the bundle they are
    /// picked by irradiance.
    struct Bundle {
        Vec3 axis{};                       ///< unit; zero: from all sides
        float cosine = 1.0f, sine = 0.0f;  ///< of the largest angle to the axis
        double irradiance = 0.0;
        std::uint32_t begin = 0, end = 0;
    };
    struct Distant {
        std::uint32_t light, bundle;
        double before, share;  ///< shares of its bundle: of the lights before it, and its own
    };

    Viewpoint scaled(const Viewpoint& from) const { return {from.position * toUnits_, from.side}; }
    void build(std::vector<PlacedLight>& lights);
    void add(const DistantLight& light, double irradiance, ShiningCone& cone);
    double importanceOf(const Bundle& bundle, const Viewpoint& from) const;

    struct Roots;
    Roots roots(const Viewpoint& from) const;
    double shareOf(const Roots& roots, const Bundle& bundle, const Viewpoint& from) const;
    Pick pickIn(const Bundle& bundle, double pmf, double u) const;
    static Pick pickIn(const Leaf& leaf, double pmf, double u);
    bool isOneLeaf() const { return leaves_.size() == 1 && distant_.empty(); }

    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
    std::vector<std::uint32_t> placeOf_;  // by light: of its leaf; distant ones follow
    std::vector<Distant> distant_;
    std::vector<Bundle> bundles_;
    SkySides sky_;
    float toUnits_ = 1.0f;  // factor from lengths to those of the tree, a power of two
};

}  // namespace lacuna

// Which light to ask for light at a point, by what the point can see of each: a tree with boxes and
// cones [Conty18], whose nodes are weighed by the bound of [Pharr23 12.6.3], of surfaces by what is
// usual below it. A node has eight
// children, which are weighed at once. (theory.md, "Lamps that are seen")
//
// Lights with a place are the tree's leaves; lights at infinity stand beside its root, weighed by
// their irradiance: those in about one direction as one, as a sun that has a size is made of many.
// A pick goes down one path, and so does the question for its probability: both take the same
// numbers in the same order, so that they agree in every bit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/scene/sky_sides.h"

namespace lacuna {

/// Where light is asked for.
struct Viewpoint {
    Vec3 position;
    Vec3 side;  ///< unit, the side that light has to come from; zero: any
};

/// Directions that light leaves along.
struct ShiningCone {
    Vec3d axis;             ///< unit
    double angle = 0;       ///< half angle; inside, light may be as strong as along the axis
    bool fades = false;     ///< outside as well, by the cosine to the cone, as from a surface
    bool twoSided = false;  ///< against the axis as well

    void add(const ShiningCone& other);
    /// Integral of what may leave, per intensity [Conty18 eq 1].
    double measure() const;
};

/// A light that has a place, or two halves of a flat one: lights that follow one another.
struct PlacedLight {
    std::uint32_t light;
    Vec3 low, high;
    ShiningCone cone;
    double intensity;  ///< the most that leaves along any direction; positive
    double share = 1;  ///< of it the first light's; 1: there is no second one
};
/// A light at infinity.
struct DistantLight {
    std::uint32_t light;
    Vec3 direction;  ///< unit, towards it; zero: from all sides
    double
        irradiance;  ///< positive, in units of intensity over squared distance; what counts of it
};

class LampTree {
  public:
    LampTree();
    LampTree(LampTree&&) noexcept;
    LampTree& operator=(LampTree&&) noexcept;
    ~LampTree();
    /// `sceneRadius`: positive. `lights`: how many there are, those without power included. `sky`: of
    /// the light that comes from all sides.
    LampTree(std::vector<PlacedLight> placed, std::span<const DistantLight> distant,
             float sceneRadius, std::size_t lights, SkySides sky = {});

    /// Whether there is more to choose from than the halves of one light, which go by power.
    bool chooses() const { return leaves_.size() + distant_.size() > 1; }

    struct Pick {
        std::uint32_t light;
        double pmf;
        double remapped;  ///< u, stretched to [0, 1) inside the outcome: to be used again
    };
    /// u in [0, 1). Not to be called on an empty tree.
    Pick pick(const Viewpoint& from, double u) const;
    /// Probability of that pick; zero for lights that are not in the tree.
    double pmf(const Viewpoint& from, std::uint32_t light) const;
    /// What it is picked in proportion to: about what arrives from it, up to a factor that all have in
    /// common, and zero only where nothing can.
    double importance(const Viewpoint& from, std::uint32_t light) const;

    std::uint64_t bytes() const;

  private:
    struct Node;
    struct Extent;
    struct Range;
    struct Shares;
    struct Leaf {
        std::uint32_t light;
        double share;  ///< of the light; the rest is that of the next one
        double shareOf(std::uint32_t l) const { return l == light ? share : 1.0 - share; }
    };
    /// Lights at infinity in about one direction, in a row; they are picked by irradiance.
    struct Bundle {
        Vec3 axis{};                       ///< unit; zero: from all sides
        float cosine = 1.0f, sine = 0.0f;  ///< of the angle that none is further from the axis by
        double irradiance = 0.0;
        std::uint32_t begin = 0, end = 0;
    };
    struct Distant {
        std::uint32_t light, bundle;
        double before, share;  ///< of its bundle: those in front of it, its own
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
    std::vector<std::uint32_t> placeOf_;  // by light: its leaf, then those at infinity
    std::vector<Distant> distant_;
    std::vector<Bundle> bundles_;
    SkySides sky_;
    float toUnits_ = 1.0f;  // lengths to those of the tree: a power of two
};

}  // namespace lacuna

// What lies in smooth glass or under water, and the ways out: convex bodies with flat faces show a lamp once
// through each of several faces; others have sides, roughly. (theory.md, "Next event through glass")
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "libcore/scene/scene.h"
#include "libcore/specular/boxes.h"
#include "libcore/specular/snell.h"

namespace lacuna {

class GlassBodies {
  public:
    static constexpr std::size_t kMostFaces = 24;  ///< of a body

    /// None.
    GlassBodies() = default;
    explicit GlassBodies(const Scene& scene);

    /// A way out of a body through one face.
    struct WayOut {
        Vec3 normal;      ///< unit, the face's, outwards
        Vec3d direction;  ///< unit, from inside the body
    };
    class WaysOut {
      public:
        std::size_t size() const { return size_; }
        const WayOut& operator[](std::size_t i) const { return ways_[i]; }
        /// The way through the face that a triangle with this unit normal, or its opposite, is of.
        const WayOut* through(const Vec3& normal) const;

      private:
        friend class GlassBodies;
        std::array<WayOut, kMostFaces> ways_;
        std::size_t size_ = 0;
    };

    /// The ways from a point through the body around it that the face alone would turn to the target,
    /// where they meet the face: none outside of all bodies. A function of both.
    WaysOut waysOut(const Vec3& from, const ChainTarget& target) const;

    /// Guesses: ways out of all other bodies around a point, through the sides that look towards the target.
    /// Also a function of both.
    WaysOut roughWaysOut(const Vec3& from, const ChainTarget& target) const;

  private:
    struct Body {
        Box box;
        std::vector<Interface> faces;
        bool contains(const Vec3d& point, double slack) const;
    };
    /// What looks along one axis of a body that is round or hollow: a plane through its middle.
    struct Side {
        Interface plane;
        Box box;     ///< around it, and somewhat wider
        Box around;  ///< around the body
    };
    static std::optional<Body> bodyOf(std::span<const std::array<Vec3, 3>> triangles, double index,
                                      double slack);
    void addSides(std::span<const std::array<Vec3, 3>> triangles, double index);

    std::vector<Body> bodies_;
    std::vector<Side> sides_;
    double slack_ = 0.0;  // what coordinates may be off by
};

}  // namespace lacuna

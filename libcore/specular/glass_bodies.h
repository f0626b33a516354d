// Bodies of smooth glass or water, and the ways out of them for points inside. A convex body with flat faces shows a
// lamp once through each of several faces. Other bodies have sides, which describe them roughly. (theory.md, "Next
// event through glass")
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

    /// No bodies.
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
        /// The way through the face that has this unit normal, or its opposite. Null where
        /// there is none.
        const WayOut* through(const Vec3& normal) const;

      private:
        friend class GlassBodies;
        std::array<WayOut, kMostFaces> ways_;
        std::size_t size_ = 0;
    };

    /// The ways from a point out of the body around it that one face alone would refract to the target, and that meet
    /// this face. Empty outside of all bodies. A function of both arguments.
    WaysOut waysOut(const Vec3& from, const ChainTarget& target) const;

    /// Guesses of ways out of all other bodies around a point, through the sides that look towards the target. Also a
    /// function of both arguments.
    WaysOut roughWaysOut(const Vec3& from, const ChainTarget& target) const;

  private:
    struct Body {
        Box box;
        std::vector<Interface> faces;
        bool contains(const Vec3d& point, double slack) const;
    };
    /// The part of a round or hollow body that looks along one axis, as a plane through the
    /// middle of that part.
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

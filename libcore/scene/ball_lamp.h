// A lamp that is about a ball: a closed convex surface of emissive triangles, as modellers make
// spheres of. Next event draws its points evenly over the solid angle that the sphere through its
// corners is seen under, and not triangle by triangle. (theory.md, "Lamps that are seen")
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libcore/base/discrete.h"
#include "libcore/base/vec.h"
#include "libcore/scene/lamp_tree.h"

namespace lacuna {

struct EmissiveTriangle;

class BallLamp {
  public:
    /// All that there are among `triangles`. Those of one have one material, no texture and no alpha,
    /// share their corners, and come nowhere much nearer to the middle than these.
    static std::vector<BallLamp> find(std::span<const EmissiveTriangle> triangles);

    /// Its triangles, by index: the first one stands for all.
    std::span<const std::uint32_t> lights() const { return lights_; }
    /// What the lamp tree knows of it, of a radiance of 1.
    PlacedLight placed() const;

    struct Point {
        std::uint32_t light;
        Vec2 uv;  ///< barycentric
    };
    /// Draws a point that `from` may see; u, u1, u2 in [0, 1). From outside of the sphere: a direction,
    /// evenly out of the cone around it, and where that meets the lamp first. It may pass by the lamp,
    /// which has corners: empty. From inside: evenly by area.
    std::optional<Point> sample(const Vec3& from, double u, float u1, float u2) const;
    /// Its density, per area; from outside zero where the lamp is turned away. `position`: on the lamp;
    /// `normal`: unit, of its triangle.
    double pdfA(const Vec3& from, const Vec3& position, const Vec3& normal) const;

  private:
    /// In radii, from the middle.
    struct Face {
        Vec3 normal;                            // unit, outwards
        Vec3 corner;                            // the first one
        Vec3 along1, along2;                    // a point's barycentrics: its products with these
        std::array<std::uint32_t, 3> across{};  // the face behind the edge opposite each corner
    };
    struct Entry {
        std::uint32_t face;
        Vec2 uv;
    };
    class Mesh;  // triangles that share corners, on their way here

    explicit BallLamp(const Mesh& mesh);
    void makeStarts();
    std::uint32_t startOf(const Vec3& direction) const;
    std::optional<Entry> enter(const Vec3& closest, const Vec3& direction) const;
    std::optional<Entry> enterFrom(std::uint32_t face, const Vec3& closest,
                                   const Vec3& direction) const;
    bool isOutside(const Vec3d& toMiddle) const;
    double versineOfCone(const Vec3d& toMiddle) const;

    Vec3d middle_;
    double radius_ = 0.0;  // of the sphere through the farthest corners
    double area_ = 0.0;
    Vec3 low_, high_;
    std::vector<std::uint32_t> lights_;  // by face
    std::vector<Face> faces_;
    DiscreteDistribution byArea_;
    std::uint32_t cells_ = 1;            // along a side of the square of directions
    std::vector<std::uint32_t> starts_;  // by its cells: the face that lies there
};

}  // namespace lacuna

// A lamp that is nearly a ball: a closed convex surface of emissive triangles, like a modeller's
// sphere. Next-event estimation samples its points uniformly over the solid angle of the sphere
// through its corners, and not triangle by triangle. (theory.md, "Lamps that are seen")
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
    /// Finds all such lamps among `triangles`. The triangles of one lamp have one material, no texture and no alpha,
    /// share their corners, and come nowhere much nearer to the centre than the corners.
    static std::vector<BallLamp> find(std::span<const EmissiveTriangle> triangles);

    /// Indices of its triangles. The first one represents the lamp in the lamp tree.
    std::span<const std::uint32_t> lights() const { return lights_; }
    /// The lamp's leaf for the lamp tree, for a radiance of 1.
    PlacedLight placed() const;

    struct Point {
        std::uint32_t light;
        Vec2 uv;              ///< barycentric
        float factor = 1.0f;  ///< of what the point brings; positive
    };
    /// Samples a point that `from` may see; u, u1, u2 in [0, 1). Outside the sphere it samples a direction uniformly in
    /// the sphere's cone and returns the first point of the lamp on it. The lamp is smaller than the sphere, so near the
    /// rim directions may miss it. There, several are tried, and one that meets it is returned, with a factor for how
    /// many do; empty if none does. Inside the sphere it samples uniformly by area.
    std::optional<Point> sample(const Vec3& from, double u, float u1, float u2) const;
    /// The density of such a point, per area, where a point counts as often as its factor says. From outside, it is zero
    /// on faces turned away. `position`: a point on the lamp; `normal`: unit normal of its triangle.
    double pdfA(const Vec3& from, const Vec3& position, const Vec3& normal) const;

  private:
    /// A face, relative to the centre and in units of the radius.
    struct Face {
        Vec3 normal;                            // unit, outwards
        Vec3 corner;                            // the first corner
        Vec3 along1, along2;                    // dot products with a point: its barycentrics
        std::array<std::uint32_t, 3> across{};  // the face across the edge opposite each corner
    };
    struct Entry {
        std::uint32_t face;
        Vec2 uv;
    };
    class Cones;
    class Rays;
    class Mesh;  // connected triangles, while lamps are being found

    explicit BallLamp(const Mesh& mesh);
    void makeStarts();
    std::uint32_t startOf(const Vec3& direction) const;
    std::optional<Entry> enter(const Vec3& closest, const Vec3& direction) const;
    std::optional<Entry> enterFrom(std::uint32_t face, const Vec3& closest,
                                   const Vec3& direction) const;
    bool isOutside(double distance2) const;

    Vec3d middle_;
    double radius_ = 0.0;  // of the sphere through the farthest corners
    double radius2_ = 0.0;
    // The square of the radius of the sphere that touches the nearest face, over radius2_.
    double within2_ = 0.0;
    // The expected share of directions between the two spheres that meet the lamp.
    double rimShare_ = 0.0;
    double area_ = 0.0;
    Vec3 low_, high_;
    std::vector<std::uint32_t> lights_;  // by face
    std::vector<Face> faces_;
    DiscreteDistribution byArea_;
    std::uint32_t cells_ = 1;            // cells along a side of the square of directions
    std::vector<std::uint32_t> starts_;  // by cell: a face in that direction
};

}  // namespace lacuna

// Finds the emissive triangles that form a ball (ball_lamp.h). (theory.md, "Balls")
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "libcore/base/union_find.h"
#include "libcore/scene/ball_lamp.h"
#include "libcore/scene/light.h"

namespace lacuna {

namespace {

constexpr std::size_t kFewestFaces = 8, kMostFaces = 4096;

/// How near faces may come to the centre, in radii. The faces of an icosahedron come to .79, those of a cube to .58.
constexpr double kRoundness = 0.75;

/// The largest dent between faces, in radii. If the corners' positions are less precise, the lamp
/// is no ball.
constexpr double kDent = 1e-4;

/// Corners within this distance, relative to the largest coordinate, are merged: at a sphere's seam, modellers' sines
/// differ by rounding.
constexpr double kWeld = 0x1p-21;

using Corners = std::array<std::uint32_t, 3>;

/// The precision of the corners: a step at the largest coordinate.
double stepOf(std::span<const EmissiveTriangle> triangles) {
    double most = 0.0;
    for (const EmissiveTriangle& t : triangles) {
        for (const Vec3& c : t.corners) {
            most = std::max(
                {most, std::abs(double(c.x)), std::abs(double(c.y)), std::abs(double(c.z))});
        }
    }
    return most * kWeld;
}

/// A number for each corner of each triangle. Corners with the same position and material share a
/// number.
std::vector<Corners> numberedCorners(std::span<const EmissiveTriangle> triangles, double step) {
    using Place = std::tuple<std::uint32_t, long long, long long, long long>;
    std::vector<std::pair<Place, std::size_t>> places;
    places.reserve(3 * triangles.size());
    const auto cell = [&](float x) { return std::llround(double(x) / step); };
    for (const EmissiveTriangle& t : triangles) {
        for (const Vec3& c : t.corners) {
            places.emplace_back(Place{t.material, cell(c.x), cell(c.y), cell(c.z)}, places.size());
        }
    }
    std::sort(places.begin(), places.end());
    std::vector<Corners> numbers(triangles.size());
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (i > 0 && places[i].first != places[i - 1].first) ++number;
        numbers[places[i].second / 3][places[i].second % 3] = number;
    }
    return numbers;
}

}  // namespace

class BallLamp::Mesh {
  public:
    explicit Mesh(std::span<const EmissiveTriangle> all) : all_(all) {}

    void add(std::uint32_t light, const Corners& corners) {
        lights.push_back(light);
        corners_.push_back(corners);
    }
    /// Computes the faces; false if they form no ball. `step`: precision of coordinates.
    bool isBall(double step);

    std::vector<std::uint32_t> lights;
    std::vector<Face> faces;
    std::vector<double> areas;
    Vec3 low, high;
    Vec3d middle;
    double radius = 0.0;
    double within = 1.0;  // least distance of a face from the middle, in radii

  private:
    const std::array<Vec3, 3>& places(std::size_t face) const { return all_[lights[face]].corners; }
    Vec3d fromMiddle(std::size_t face, std::size_t corner) const {
        return (Vec3d(places(face)[corner]) - middle) * (1.0 / radius);
    }
    void measure();
    bool isClosed();
    double addFace(std::size_t i);
    bool isDentedAt(std::size_t face, std::size_t corner) const;

    std::span<const EmissiveTriangle> all_;
    std::vector<Corners> corners_;
};

/// A ball is convex at every edge, and seen from its centre the backs of its faces cover the sphere
/// once.
bool BallLamp::Mesh::isBall(double step) {
    if (lights.size() < kFewestFaces || lights.size() > kMostFaces) return false;
    const Rgb radiance = all_[lights[0]].radiance;
    for (const std::uint32_t l : lights) {
        if (all_[l].radiance != radiance) return false;
    }
    measure();
    if (!(radius * kDent > step)) return false;
    faces.resize(lights.size());
    if (!isClosed()) return false;
    double solidAngle = 0.0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        solidAngle += addFace(i);
        within = std::min(within, double(dot(faces[i].normal, faces[i].corner)));
    }
    if (within < kRoundness) return false;
    if (std::abs(solidAngle - 4.0 * std::numbers::pi) > 0.01) return false;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            if (isDentedAt(i, corner)) return false;
        }
    }
    return true;
}

void BallLamp::Mesh::measure() {
    low = high = places(0)[0];
    for (std::size_t i = 0; i < lights.size(); ++i) {
        for (const Vec3& c : places(i)) {
            low = min(low, c);
            high = max(high, c);
        }
    }
    middle = (Vec3d(low) + Vec3d(high)) * 0.5;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        for (const Vec3& c : places(i)) radius = std::max(radius, length(Vec3d(c) - middle));
    }
}

/// Whether each edge belongs to two faces, which run along it in opposite directions. Also finds
/// these neighbours.
bool BallLamp::Mesh::isClosed() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::size_t, std::size_t>> edges;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::pair edge{corners_[i][(c + 1) % 3], corners_[i][(c + 2) % 3]};
            if (!edges.try_emplace(edge, i, c).second) return false;
        }
    }
    for (const auto& [edge, at] : edges) {
        const auto back = edges.find({edge.second, edge.first});
        if (back == edges.end()) return false;
        faces[at.first].across[at.second] = std::uint32_t(back->second.first);
    }
    return true;
}

/// Adds a face and returns its solid angle seen from the centre [Van Oosterom and Strackee 1983].
double BallLamp::Mesh::addFace(std::size_t i) {
    const Vec3d a = fromMiddle(i, 0), b = fromMiddle(i, 1), c = fromMiddle(i, 2);
    const Vec3d n = cross(b - a, c - a);
    areas.push_back(0.5 * length(n) * radius * radius);
    Face& f = faces[i];
    f.normal = Vec3(normalize(n));
    f.corner = Vec3(a);
    f.along1 = Vec3(cross(c - a, n) * (1.0 / lengthSquared(n)));
    f.along2 = Vec3(cross(n, b - a) * (1.0 / lengthSquared(n)));
    const double la = length(a), lb = length(b), lc = length(c);
    return 2.0 * std::atan2(dot(a, cross(b, c)),
                            la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// Whether the face across the edge that is opposite `corner` rises above this one.
bool BallLamp::Mesh::isDentedAt(std::size_t face, std::size_t corner) const {
    const Face& f = faces[face];
    const std::size_t other = f.across[corner];
    for (std::size_t c = 0; c < 3; ++c) {
        const Vec3d v = fromMiddle(other, c) - Vec3d(f.corner);
        if (dot(Vec3d(f.normal), v) > kDent) return true;
    }
    return false;
}

BallLamp::BallLamp(const Mesh& mesh)
    : middle_(mesh.middle),
      radius_(mesh.radius),
      radius2_(radius_ * radius_),
      within2_(mesh.within * mesh.within),
      area_(std::accumulate(mesh.areas.begin(), mesh.areas.end(), 0.0)),
      low_(mesh.low),
      high_(mesh.high),
      lights_(mesh.lights),
      faces_(mesh.faces),
      byArea_(mesh.areas) {
    // From afar, a convex body has a quarter of its surface as its outline in the mean over all sides [Cauchy].
    const double outline = area_ / (4.0 * std::numbers::pi * radius2_);
    rimShare_ = (outline - within2_) / (1.0 - within2_);
    makeStarts();
}

std::vector<BallLamp> BallLamp::find(std::span<const EmissiveTriangle> triangles) {
    const double step = stepOf(triangles);
    if (!(step > 0.0)) return {};
    const std::vector<Corners> corners = numberedCorners(triangles, step);
    const auto mayBelong = [&](std::size_t i) {
        const EmissiveTriangle& t = triangles[i];
        const Corners& c = corners[i];
        // At a pole of a sphere there may be degenerate triangles.
        return !t.texture && !t.alpha && !isBlack(t.radiance) && c[0] != c[1] && c[1] != c[2] &&
               c[2] != c[0];
    };
    UnionFind parts(3 * triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (!mayBelong(i)) continue;
        parts.join(corners[i][0], corners[i][1]);
        parts.join(corners[i][1], corners[i][2]);
    }
    std::map<std::uint32_t, Mesh> meshes;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (!mayBelong(i)) continue;
        meshes.try_emplace(parts.find(corners[i][0]), triangles)
            .first->second.add(std::uint32_t(i), corners[i]);
    }
    std::vector<BallLamp> balls;
    for (auto& [part, mesh] : meshes) {
        if (mesh.isBall(step)) balls.push_back(BallLamp(mesh));
    }
    return balls;
}

}  // namespace lacuna

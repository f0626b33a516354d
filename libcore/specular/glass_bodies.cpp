// (theory.md, "Next event through glass")
#include "libcore/specular/glass_bodies.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <unordered_map>

#include "libcore/base/union_find.h"

namespace lacuna {

namespace {

using Triangle = std::array<Vec3, 3>;

constexpr std::size_t kMostBodies = 64, kMostSides = 64;
constexpr double kSlack = 1e-5;     // of the scene's radius
constexpr double kSameFace = 1e-6;  // 1 - cosine between normals: a thousandth of a radian
constexpr float kWider = 0.1f;      // of a side's box: it is not flat

struct HashOfPlace {
    std::size_t operator()(const Vec3& p) const {
        std::uint64_t hash = 0;
        for (const float x : {p.x, p.y, p.z}) {
            // Zero has two signs, which are one place.
            hash = (hash ^ std::bit_cast<std::uint32_t>(x + 0.0f)) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 32;
        }
        return std::size_t(hash);
    }
};

/// Numbers for corners, the same where they lie in the same place.
std::vector<std::array<std::uint32_t, 3>> cornersOf(std::span<const Triangle> triangles) {
    std::unordered_map<Vec3, std::uint32_t, HashOfPlace> numbers;
    numbers.reserve(triangles.size());
    std::vector<std::array<std::uint32_t, 3>> all;
    all.reserve(triangles.size());
    for (const Triangle& triangle : triangles) {
        std::array<std::uint32_t, 3> corners;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto next = std::uint32_t(numbers.size());
            corners[c] = numbers.try_emplace(triangle[c], next).first->second;
        }
        all.push_back(corners);
    }
    return all;
}

/// Parts that hang together by shared corners, each as a list of triangles.
std::vector<std::vector<Triangle>> connectedParts(std::span<const Triangle> triangles) {
    const auto corners = cornersOf(triangles);
    UnionFind sets(3 * triangles.size());
    for (const auto& [a, b, c] : corners) {
        sets.join(a, b);
        sets.join(a, c);
    }
    constexpr std::uint32_t kNone = ~0u;
    std::vector<std::uint32_t> partOf(3 * triangles.size(), kNone);
    std::vector<std::vector<Triangle>> parts;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        std::uint32_t& part = partOf[sets.find(corners[i][0])];
        if (part == kNone) {
            part = std::uint32_t(parts.size());
            parts.emplace_back();
        }
        parts[part].push_back(triangles[i]);
    }
    return parts;
}

/// The mean of all corners: inside of what is convex.
Vec3d middleOf(std::span<const Triangle> triangles) {
    Vec3d sum;
    for (const auto& [a, b, c] : triangles) sum += Vec3d(a) + Vec3d(b) + Vec3d(c);
    return sum * (1.0 / (3.0 * double(triangles.size())));
}

bool contains(const Box& box, const Vec3& point) {
    return point.x >= box.low.x && point.x <= box.high.x && point.y >= box.low.y &&
           point.y <= box.high.y && point.z >= box.low.z && point.z <= box.high.z;
}

double volumeOf(const Box& box) {
    const Vec3d size = Vec3d(box.high) - Vec3d(box.low);
    return size.x * size.y * size.z;
}

/// Half of the box's surface.
double areaOf(const Box& box) {
    const Vec3d size = Vec3d(box.high) - Vec3d(box.low);
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Where a ray meets a plane.
Vec3d placeOn(const Interface& plane, const Vec3d& start, const Vec3d& direction) {
    const double distance =
        (plane.offset - dot(start, plane.normal)) / dot(direction, plane.normal);
    return start + direction * distance;
}

/// Whether each edge is that of two triangles.
bool isClosed(std::span<const Triangle> triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& corners : cornersOf(triangles)) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [a, b] = std::minmax(corners[i], corners[(i + 1) % 3]);
            ++edges[{a, b}];
        }
    }
    return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 2; });
}

}  // namespace

bool GlassBodies::Body::contains(const Vec3d& point, double slack) const {
    return std::ranges::all_of(faces, [&](const Interface& face) {
        return dot(point, face.normal) - face.offset <= slack;
    });
}

/// Empty where the body is not convex, not closed, or has too many faces, as round ones have.
std::optional<GlassBodies::Body> GlassBodies::bodyOf(std::span<const Triangle> triangles,
                                                     double index, double slack) {
    Body body{around(triangles, float(slack)), {}};
    const Vec3d middle = middleOf(triangles);
    for (const auto& [a, b, c] : triangles) {
        Vec3d n = normalize(cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a)));
        if (dot(n, Vec3d(a) - middle) < 0.0) n = -n;  // of a mirrored copy
        const auto same = std::ranges::find_if(body.faces, [&](const Interface& face) {
            return dot(face.normal, n) > 1.0 - kSameFace;
        });
        if (same != body.faces.end()) continue;
        if (body.faces.size() == kMostFaces) return std::nullopt;
        body.faces.push_back({n, dot(n, Vec3d(a)), index});
    }
    for (const Triangle& triangle : triangles) {
        for (const Vec3& corner : triangle) {
            if (!body.contains(Vec3d(corner), slack)) return std::nullopt;
        }
    }
    if (!isClosed(triangles)) return std::nullopt;
    return body;
}

GlassBodies::GlassBodies(const Scene& scene) : slack_(kSlack * double(scene.radius())) {
    const std::span<const Material> materials = scene.description().materials;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const Material& material = materials[i];
        if (!mayBeClearGlass(material) || material.thin) continue;
        for (const std::vector<Triangle>& part : connectedParts(scene.trianglesOf(i))) {
            std::optional<Body> body = bodyOf(part, double(material.ior), slack_);
            if (body) {
                bodies_.push_back(std::move(*body));
            } else {
                addSides(part, double(material.ior));
            }
        }
    }
    // Keeps the largest bodies, and the smallest of them first: a body inside of another one
    // comes before it.
    const auto volume = [](const Body& body) { return volumeOf(body.box); };
    std::ranges::stable_sort(bodies_, std::greater(), volume);
    if (bodies_.size() > kMostBodies) bodies_.resize(kMostBodies);
    std::ranges::reverse(bodies_);
    const auto area = [](const Side& side) { return areaOf(side.box); };
    std::ranges::stable_sort(sides_, std::greater(), area);
    if (sides_.size() > kMostSides) sides_.resize(kMostSides);
}

/// Adds a side for each of the six directions along axes, of the triangles that look that way most.
void GlassBodies::addSides(std::span<const Triangle> triangles, double index) {
    const Box whole = around(triangles, 0.0f);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
            Vec3d normal, middle;  // weighted by area, half the length of n
            double area = 0.0;
            std::vector<Triangle> those;
            for (const Triangle& triangle : triangles) {
                const auto& [a, b, c] = triangle;
                const Vec3d n = cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
                if (!(n[axis] * sign >= std::sqrt(1.0 / 3.0) * length(n))) continue;
                normal += n;
                middle += (Vec3d(a) + Vec3d(b) + Vec3d(c)) * (length(n) / 3.0);
                area += length(n);
                those.push_back(triangle);
            }
            if (!(area > 0.0)) continue;
            normal = normalize(normal);
            Box box = around(those, float(slack_));
            const Vec3 wide = (box.high - box.low) * kWider;
            box = {box.low - wide, box.high + wide};
            sides_.push_back({{normal, dot(normal, middle) / area, index}, box, whole});
        }
    }
}

const GlassBodies::WayOut* GlassBodies::WaysOut::through(const Vec3& normal) const {
    const std::span<const WayOut> ways(ways_.data(), size_);
    const auto likeness = [&](const WayOut& way) { return std::fabs(dot(way.normal, normal)); };
    const auto best = std::ranges::max_element(ways, {}, likeness);
    return best != ways.end() && likeness(*best) > 1.0f - 2.0f * float(kSameFace) ? &*best
                                                                                  : nullptr;
}

GlassBodies::WaysOut GlassBodies::waysOut(const Vec3& from, const ChainTarget& target) const {
    WaysOut ways;
    const Vec3d start(from);
    const auto body = std::ranges::find_if(
        bodies_, [&](const Body& b) { return contains(b.box, from) && b.contains(start, slack_); });
    if (body == bodies_.end()) return ways;
    for (const Interface& face : body->faces) {
        const std::optional<Vec3d> way = refractedWay(start, face, target);
        if (!way) continue;
        if (!body->contains(placeOn(face, start, *way), slack_)) continue;
        ways.ways_[ways.size_++] = {Vec3(face.normal), *way};
    }
    return ways;
}

GlassBodies::WaysOut GlassBodies::roughWaysOut(const Vec3& from, const ChainTarget& target) const {
    WaysOut ways;
    const Vec3d start(from);
    for (const Side& side : sides_) {
        if (ways.size_ == kMostFaces) break;
        if (!contains(side.around, from)) continue;
        const std::optional<Vec3d> way = refractedWay(start, side.plane, target);
        if (!way) continue;
        if (!contains(side.box, Vec3(placeOn(side.plane, start, *way)))) continue;
        ways.ways_[ways.size_++] = {Vec3(side.plane.normal), *way};
    }
    return ways;
}

}  // namespace lacuna

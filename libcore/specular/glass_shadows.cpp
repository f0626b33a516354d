// (theory.md, "Next event through glass")
#include "libcore/specular/glass_shadows.h"

#include <cmath>
#include <functional>
#include <utility>

#include "libcore/specular/glass_boxes.h"
#include "libcore/specular/triangles_by_area.h"

namespace lacuna {

namespace {

constexpr int kLampDivisions = 2;
constexpr int kRays = 32;  // from a box of glass to a box of lamps

/// The triangles of lamps that shine at all, in boxes. Those of two-sided lamps are there twice.
std::vector<BoxedTriangles> lampsInBoxes(const Scene& scene) {
    const Lights& lights = scene.lights();
    std::vector<std::array<Vec3, 3>> triangles;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (lights.kind(i) != LightKind::Area || !(lights.powerShare(i) > 0.0)) continue;
        const auto& [a, b, c] = lights.corners(i);
        triangles.push_back({a, b, c});
        if (lights.twoSided(i)) triangles.push_back({a, c, b});
    }
    return inBoxes(std::move(triangles), kLampDivisions, boxMargin(scene));
}

/// Points and spots in boxes, as triangles without a size.
std::vector<BoxedTriangles> pointsInBoxes(const Scene& scene) {
    const Lights& lights = scene.lights();
    std::vector<std::array<Vec3, 3>> points;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (isHittable(lights.kind(i)) || isInfinite(lights.kind(i))) continue;
        const Vec3 at = lights.punctualPoint(i).position;
        points.push_back({at, at, at});
    }
    return inBoxes(std::move(points), kLampDivisions, boxMargin(scene));
}

/// The unit directions towards suns.
std::vector<Vec3> parallelLight(const Scene& scene) {
    const Lights& lights = scene.lights();
    std::vector<Vec3> directions;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (lights.kind(i) != LightKind::Directional) continue;
        directions.push_back(lights.punctualPoint(i).position);
    }
    return directions;
}

/// Expected number of tries where this share of the light comes as far as the glass. The best number of samples is
/// proportional to the root of what they bring, and half of a body's surface is turned away from the lamp.
double triesFor(double shareLit) {
    return std::clamp(2.0 * std::sqrt(shareLit), GlassShadows::kLeast, 1.0);
}

/// Share of the glass that light reaches, by random points on it. `shines(point, normal)` says whether light
/// comes to a point.
template <class Shines>
double shareLit(const TrianglesByArea& glass, Rng& rng, const Shines& shines) {
    int lit = 0;
    for (int i = 0; i < kRays; ++i) {
        const TrianglesByArea::Point at = glass.sample(rng);
        lit += shines(at.position, glass.normal(at.triangle)) ? 1 : 0;
    }
    return double(lit) / kRays;
}

}  // namespace

GlassShadows::GlassShadows(const Scene& scene, std::span<const BoxedTriangles> glass,
                           std::span<const BoxedTriangles> facets) {
    const Environment* sky = scene.environment();
    Rng rng(0, 0, StreamKind::Refraction, ~std::uint64_t(0));
    RayTally ignored;
    std::vector<Pair> pairs;
    const auto add = [&](const Box& around, const Box& lamp, bool isSky, double lit) {
        pairs.push_back({around, lamp, isSky, std::uint8_t(std::lround(triesFor(lit) / kOfCode))});
    };
    std::vector<BoxedTriangles> points;
    std::vector<Vec3> suns;
    if (!facets.empty()) {
        points = pointsInBoxes(scene);
        suns = parallelLight(scene);
    }
    for (const BoxedTriangles& part : facets) {
        const TrianglesByArea byArea(part.triangles);
        const auto one = [&](const auto& all) { return all[rng.below(std::uint32_t(all.size()))]; };
        for (const BoxedTriangles& lamp : points) {
            add(part.box, lamp.box, false, shareLit(byArea, rng, [&](Vec3 at, Vec3 normal) {
                    return scene.visible(at, normal, one(lamp.triangles)[0], {}, RayKind::Chain,
                                         ignored);
                }));
        }
        if (suns.empty()) continue;
        add(part.box, {}, true, shareLit(byArea, rng, [&](Vec3 at, Vec3 normal) {
                return scene.visibleToInfinity(at, normal, one(suns), RayKind::Chain, ignored);
            }));
    }
    const std::vector<BoxedTriangles> lamps = lampsInBoxes(scene);
    std::vector<TrianglesByArea> lampsByArea;
    for (const BoxedTriangles& lamp : lamps) lampsByArea.emplace_back(lamp.triangles);
    for (const BoxedTriangles& part : glass) {
        const TrianglesByArea byArea(part.triangles);
        for (std::size_t i = 0; i < lamps.size(); ++i) {
            const TrianglesByArea& lamp = lampsByArea[i];
            add(part.box, lamps[i].box, false, shareLit(byArea, rng, [&](Vec3 at, Vec3 normal) {
                    const auto from = lamp.sample(rng);
                    const Vec3 front = lamp.normal(from.triangle);
                    return dot(front, at - from.position) > 0.0f &&
                           scene.visible(at, normal, from.position, front, RayKind::Chain, ignored);
                }));
        }
        if (sky && !sky->black()) {
            add(part.box, {}, true, shareLit(byArea, rng, [&](Vec3 at, Vec3 normal) {
                    const Rng::Draw u = rng.draw();
                    return scene.visibleToInfinity(at, normal,
                                                   sky->sample(u.pick, u.u1, u.u2).direction,
                                                   RayKind::Chain, ignored);
                }));
        }
    }
    if (pairs.empty()) return;
    std::ranges::stable_sort(pairs, std::greater(), &Pair::code);
    const Vec3 half = scene.halfSize();
    const auto toCells = [](float h) { return h > 0.0f ? 0.5f * float(kSide) / h : 0.0f; };
    toCells_ = {toCells(half.x), toCells(half.y), toCells(half.z)};
    cells_.assign(kSide * kSide * kSide, 0);
    rows_.assign(kSide * kSide, 0);
    fill({0, 0, 0, kSide}, pairs, half, boxMargin(scene));
}

Box GlassShadows::boxOf(const Cube& cube, const Vec3& half, float margin) const {
    const auto corner = [&](std::size_t x, std::size_t y, std::size_t z, float wider) {
        const auto at = [&](std::size_t i, float h) {
            return (2.0f * float(i) / float(kSide) - 1.0f) * h + wider;
        };
        return Vec3{at(x, half.x), at(y, half.y), at(z, half.z)};
    };
    return {corner(cube.x, cube.y, cube.z, -margin),
            corner(cube.x + cube.side, cube.y + cube.side, cube.z + cube.side, margin)};
}

/// Sets the cells of a cube to the best of `pairs`, which come best first. Glass that lies between its lamp and no
/// point of the cube lies between the lamp and none of the cube's parts. So the parts begin with the first pair that
/// serves the cube.
void GlassShadows::fill(const Cube& cube, std::span<const Pair> pairs, const Vec3& half,
                        float margin) {
    const Box box = boxOf(cube, half, margin);
    const auto first = std::ranges::find_if(pairs, [&](const Pair& pair) {
        return pair.sky || mayLieBetween(pair.glass, box, pair.lamp);
    });
    if (first == pairs.end()) return;
    if (cube.side == 1) {
        const std::size_t row = cube.z * kSide + cube.y;
        cells_[row * kSide + cube.x] = first->code;
        rows_[row] |= std::uint32_t(1) << cube.x;
        return;
    }
    const std::size_t side = cube.side / 2;
    for (int i = 0; i < 8; ++i) {
        const Cube part{cube.x + (i & 1 ? side : 0), cube.y + (i & 2 ? side : 0),
                        cube.z + (i & 4 ? side : 0), side};
        fill(part, {first, pairs.end()}, half, margin);
    }
}

}  // namespace lacuna

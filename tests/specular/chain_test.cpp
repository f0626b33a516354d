// Chains of mirrors and smooth glass: their derivatives by the first ray, and how many a search finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "libcore/material/fresnel.h"
#include "libcore/material/microfacet.h"
#include "libcore/specular/chain_search.h"
#include "libcore/specular/chain_seeds.h"
#include "libcore/specular/glass_boxes.h"
#include "tests/material/statistics.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

constexpr int kFew = 12;  // columns of a ball

/// A ball of triangles; by default of few, so that normals change much within each.
Mesh ball(Vec3 centre, float radius, std::uint32_t material, int columns = kFew) {
    const int rows = columns / 2;
    Mesh m;
    m.material = material;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            const double phi = 2 * std::numbers::pi * i / columns;
            const double theta = std::numbers::pi * j / rows;
            const Vec3 n(Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta),
                               std::sin(theta) * std::sin(phi)});
            m.positions.push_back(centre + n * radius);
            m.normals.push_back(n);
            m.uvs.push_back({float(i) / columns, float(j) / rows});
        }
    }
    const auto at = [=](int j, int i) { return std::uint32_t(j * (columns + 1) + i); };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            m.triangles.push_back({at(j, i), at(j, i + 1), at(j + 1, i)});
            m.triangles.push_back({at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)});
        }
    }
    return m;
}

/// The same chain along another first ray; empty if a vertex leaves its triangle.
std::optional<Chain> again(const Scene& scene, const Chain& chain, const Vec3d& direction) {
    RayTally tally;
    Chain moved(MovingRay::from(chain.first().origin, direction));
    while (moved.size() < chain.size()) {
        const auto hit = scene.trace(Vec3(moved.last().origin), moved.lastNormal(),
                                     Vec3(moved.last().direction), RayKind::Chain, tally);
        const ChainVertex& before = chain[moved.size()];
        if (!hit || !moved.extend(scene, *hit, before.event, before.facet)) return std::nullopt;
        // The change of a shading normal jumps from triangle to triangle.
        const SurfacePoint& p = moved[moved.size() - 1].point;
        const SurfacePoint& q = chain[moved.size() - 1].point;
        if (!(p.ng == q.ng)) return std::nullopt;
    }
    return moved;
}

/// Follows rays through the ball by random events and compares the derivatives of the last ray with differences. A
/// share `kinks` of the comparisons may disagree.
void expectDerivatives(const Scene& scene, double step, double tolerance, double kinks = 0) {
    RayTally tally;
    Rng rng(1, 0, StreamKind::User, 0);
    int compared = 0, different = 0;
    for (int n = 0; n < 3000; ++n) {
        const Vec3d target{rng.uniform() * 1.6 - 0.8, rng.uniform() * 1.6 - 0.8, 0};
        const Vec3d origin{0.1, 0.2, 3};
        Chain chain(MovingRay::from(origin - scene.centre(), normalize(target - origin)));
        const std::size_t wanted = 1 + rng.below(3);
        while (chain.size() < wanted) {
            const auto hit = scene.trace(Vec3(chain.last().origin), chain.lastNormal(),
                                         Vec3(chain.last().direction), RayKind::Chain, tally);
            if (!hit) break;
            const FacetSlope facet = sampleFacet(rng.uniformDouble(), rng.uniformDouble());
            if (!chain.extend(scene, *hit, rng.uniformDouble()) &&
                !chain.extend(scene, *hit, {.event = ScatterEvent::Smooth}, facet)) {
                break;
            }
        }
        if (chain.size() == 0) continue;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3d turn = chain.first().directionBy[i] * step;
            const Vec3d along = chain.firstDirection();
            const auto more = again(scene, chain, normalize(along + turn));
            const auto less = again(scene, chain, normalize(along - turn));
            if (!more || !less) continue;
            const auto compare = [&](const Vec3d& by, const Vec3d& a, const Vec3d& b) {
                const Vec3d difference = (a - b) * (0.5 / step);
                ++compared;
                different += length(by - difference) < tolerance * (1 + length(by)) ? 0 : 1;
            };
            const MovingRay& last = chain.last();
            compare(last.directionBy[i], more->last().direction, less->last().direction);
            // The origin moves along the surface, and the difference along a chord of it.
            compare(last.originBy[i], more->last().origin, less->last().origin);
        }
    }
    EXPECT_GT(compared, 2000);
    EXPECT_LE(different, kinks * compared);
}

TEST(Chain, movesAsItsDerivativesSay) {
    SceneBuilder b;
    b.add(ball({0, 0, 0}, 1, b.add(glass(1.4f))));
    expectDerivatives(*b.build(), 1e-8, 1e-4);
}

lacuna::Material frostedPane() {
    lacuna::Material m = pane({0.9f, 0.9f, 0.9f});
    m.roughness = 0.3f;
    return m;
}

TEST(Chain, movesAsItsDerivativesSayByFacets) {
    SceneBuilder b;
    b.add(ball({0, 0, 0}, 1, b.add(glass(1.4f, 0.3f))));
    expectDerivatives(*b.build(), 1e-8, 1e-4);
    SceneBuilder sheet;
    sheet.add(ball({0, 0, 0}, 1, sheet.add(frostedPane())));
    expectDerivatives(*sheet.build(), 1e-8, 1e-4);
}

/// A facet is found again from the directions that it refracts between, and is drawn with the density that it states.
void expectFacetsKnown(const lacuna::Material& material, double alpha) {
    Rng rng(1, 0, StreamKind::User, 0);
    SceneBuilder b;
    b.add(box({-1, -1, -1}, {1, 1, 1}, b.add(material)), rotation({3, 1, 2}, 20));
    const auto scene = b.build();
    const double index = double(material.ior);
    const double share = kSteepest * kSteepest / (1 + kSteepest * kSteepest);
    double whole = 0;
    RayTally tally;
    int found = 0;
    for (int n = 0; n < 2000; ++n) {
        const FacetSlope facet = sampleFacet(rng.uniformDouble(), rng.uniformDouble());
        // The mean of 1 / p is the solid angle of all directions that are not too steep.
        whole += 1 / pdfOfFacet(facet, alpha) / 2000;
        EXPECT_LT(std::hypot(facet.s, facet.t), kSteepest);
        const Vec3d target{rng.uniform() * 1.6 - 0.8, rng.uniform() * 1.6 - 0.8, 0};
        const Vec3d origin{0.1, 0.2, 3};
        Chain chain(MovingRay::from(origin - scene->centre(), normalize(target - origin)));
        const auto hit = scene->trace(Vec3(chain.last().origin), chain.lastNormal(),
                                      Vec3(chain.last().direction), RayKind::Chain, tally);
        if (!hit || !chain.extend(*scene, *hit, {.event = ScatterEvent::Smooth}, facet)) continue;
        const ChainVertex& v = chain[0];
        const auto again = facetBetween(v.bsdf, v.toEye, v.toLight);
        ASSERT_TRUE(again);
        EXPECT_NEAR(again->s, facet.s, 1e-4 * (1 + std::fabs(facet.s)));
        EXPECT_NEAR(again->t, facet.t, 1e-4 * (1 + std::fabs(facet.t)));
        // An eye walk draws from the facets that it sees, and is transmitted by 1 - F of them.
        const double pdfW =
            double(v.bsdf.evaluate(v.toEye, v.toLight, ScatterEvent::Smooth).pdfWToLight);
        const Vec3d normal(v.bsdf.ns());
        const Vec3d facing = facetAbout({normal, {}}, *again, alpha).at;
        const double ofFacet = dot(Vec3d(v.toEye), facing), cosine = dot(Vec3d(v.toEye), normal);
        const double seen = ggx::g1OverCosine(cosine, ggx::smithS(cosine, alpha * alpha)) *
                            ofFacet / dot(facing, normal) * (1 - fresnelDielectric(ofFacet, index));
        EXPECT_NEAR(v.measure * share * seen / pdfW, 1, 2e-3);
        ++found;
    }
    EXPECT_GT(found, 300);
    const double steepest = std::atan(kSteepest * alpha);
    EXPECT_NEAR(whole / (2 * std::numbers::pi * (1 - std::cos(steepest))), 1, 0.2);
}
TEST(Chain, knowsItsFacets) {
    expectFacetsKnown(glass(1.4f, 0.3f), 0.09);
    expectFacetsKnown(frostedPane(), 0.09);
}

TEST(Chain, movesAsItsDerivativesSayInAnInstance) {
    SceneBuilder b;
    const auto mesh = b.add(ball({0, 0, 0}, 1, b.add(glass(1.4f))),
                            rotation({1, 2, 3}, 40) * scaling({1, 0.8, 1.2}));
    b.instance(mesh, translation({9, 0, 0}));
    expectDerivatives(*b.build(), 1e-8, 1e-4);
}

TEST(Chain, movesAsItsDerivativesSayUnderANormalMap) {
    SceneBuilder b;
    lacuna::Material bumpy = glass(1.4f);
    bumpy.normalTexture = b.add(waves());
    b.add(ball({0, 0, 0}, 1, b.add(bumpy)));
    // Bilinear texels in float are less exact.
    expectDerivatives(*b.build(), 1e-4, 0.05, 0.02);
}

TEST(Chain, movesAsItsDerivativesSayUnderLacquerOfItsOwn) {
    SceneBuilder b;
    lacuna::Material lacquer = metal(Rgb(0.8f), 0);
    lacquer.clearcoat = 0.5f;
    lacquer.clearcoatNormalTexture = b.add(waves());
    b.add(ball({0, 0, 0}, 1, b.add(lacquer)));
    expectDerivatives(*b.build(), 1e-4, 0.05, 0.02);
    lacquer.normalTexture = lacquer.clearcoatNormalTexture;
    lacquer.clearcoatNormalTexture = {};
    b.d.materials.back() = lacquer;
    expectDerivatives(*b.build(), 1e-4, 0.05, 0.02);
}

/// A start at the file's origin that looks up.
ChainStart floorOf(const Scene& scene) {
    return {-Vec3(scene.centre()), {0, 1, 0}, {0, 1, 0}};
}
/// A lamp at a position of the file.
ChainTarget lampAt(const Scene& scene, Vec3d position) {
    return {Vec3(position - scene.centre())};
}

/// The total worth of the chains that one search finds.
double worthOf(const ChainSearch& search, const ChainQuery& query, const WaysNearby& ways,
               Rng& rng) {
    RayTally tally;
    double all = 0.0;
    search.sample(query, ways, rng, tally,
                  [&](const FoundChain&, const ChainSearch::Worth& worth) { all += worth(); });
    return all;
}

/// The chain that one search without known ways finds.
std::optional<FoundChain> oneOf(const ChainSearch& search, const ChainQuery& query, Rng& rng) {
    RayTally tally;
    std::optional<FoundChain> one;
    search.sample(query, {}, rng, tally,
                  [&](const FoundChain& found, const ChainSearch::Worth&) { one = found; });
    return one;
}

/// A chain is worth one over its probability, so the mean of the total worth is the number of chains.
void expectChains(const Scene& scene, const ChainTarget& target, std::size_t most, double chains,
                  int searches, const WaysNearby& ways = {}) {
    const ChainSearch search(scene);
    const ChainQuery query{floorOf(scene), target, most};
    Rng rng(2, 0, StreamKind::User, 0);
    Moments worth;
    for (int i = 0; i < searches; ++i) worth.add(worthOf(search, query, ways, rng));
    EXPECT_LT(std::fabs(worth.mean() - chains), 5 * worth.standardError())  // 6e-7 by chance
        << worth.mean() << " +- " << worth.standardError();
    EXPECT_LT(worth.standardError(), 0.1 * chains);
}

/// Each mirror shows one image of the lamp. Both together show two, one for each order.
TEST(ChainSearch, findsEachImageInTwoMirrorsOnce) {
    SceneBuilder b;
    const auto silver = b.add(mirror());
    b.add(quad({-1, -5, 5}, {0, 0, -10}, {0, 10, 0}, silver));
    b.add(quad({1, -5, -5}, {0, 0, 10}, {0, 10, 0}, silver));
    const auto scene = b.build();
    const ChainTarget lamp = lampAt(*scene, {0.3, 1.5, 0.2});
    expectChains(*scene, lamp, 1, 2, 4000);
    expectChains(*scene, lamp, 2, 4, 8000);
}

/// A slab between start and target: the straight chain, and one with two reflections inside. Each also counts without
/// its last vertex, because searches do not ask for visibility.
TEST(ChainSearch, findsTheWayThroughASlab) {
    SceneBuilder b;
    const auto clear = b.add(glass());
    b.add(quad({-50, 1.2f, 50}, {100, 0, 0}, {0, 0, -100}, clear));
    b.add(quad({-50, 1, -50}, {100, 0, 0}, {0, 0, 100},
               clear));  // faces down, and there are no sides
    const auto scene = b.build();
    const ChainTarget lamp = lampAt(*scene, {0.5, 2.5, 0.1});
    const ChainTarget sun{normalize(Vec3{0.3f, 0.8f, 0.2f}), true};
    for (const ChainTarget& target : {lamp, sun}) {
        expectChains(*scene, target, 3, 3, 6000);
        expectChains(*scene, target, 4, 4, 60000);
    }
}

/// A floor under a block of glass, with a sun and a lamp above. Beside them a thin sheet between two panes of solid
/// glass, with a lamp beyond each pane.
SceneBuilder litThroughGlass() {
    SceneBuilder b;
    const auto clear = b.add(glass(1.5f)), white = b.add(matte(Rgb(0.5f)));
    b.add(quad({-3, -0.001f, 3}, {6, 0, 0}, {0, 0, -6}, white));
    b.add(box({-0.4f, 0.3f, -0.4f}, {0.5f, 0.9f, 0.4f}, clear), rotation({0, 1, 0}, 24));
    b.add(box({9, -0.001f, -1}, {11, 0.001f, 1}, white));
    b.add(box({9, 0.5f, -1}, {11, 0.7f, 1}, clear));
    b.add(box({9, -0.7f, -1}, {11, -0.5f, 1}, clear));
    b.add(directionalLight({-0.2, -0.9, -0.1}, Rgb(1)));
    b.add(pointLight({0.3, 2, 0.2}, Rgb(1)));
    b.add(pointLight({10, 2, 0}, Rgb(1)));
    b.add(pointLight({10, -2, 0}, Rgb(1)));
    return b;
}

/// Known ways only say where searches begin. They may be ways through the block, reflections inside it, or nonsense:
/// searches find the same.
TEST(ChainSearch, findsWhatItFindsWhateverIsKnown) {
    const auto scene = litThroughGlass().build();
    const ChainTarget lamp = lampAt(*scene, {0.3, 2, 0.2});
    const ThreadPool threads(1);
    const ChainSeeds seeds(*scene, threads);
    const WaysNearby known = seeds.near(1, floorOf(*scene).position, {0, 1, 0});
    EXPECT_FALSE(known.usual.empty());
    EXPECT_FALSE(known.others.empty());
    // Usual ways are left to chance, other ways are left out, or the two are exchanged.
    const WaysNearby noneUsual{known.all, {}, known.usual}, noneOthers{known.all, known.usual, {}};
    const WaysNearby exchanged{known.all, known.others, known.usual};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::array<ChainSeed, 3> wrong;
    wrong[0] = {.end = {5, 5, 5}, .direction = {0, -1, 0}, .size = 3};
    wrong[1] = {.end = floorOf(*scene).position, .direction = {0, 1, 0}, .size = 1};
    wrong[1].turn = {{{nan, 0}, {0, nan}}};
    wrong[2] = {.end = {1, 2, 3}, .direction = {0, 1, 0}, .size = 1};
    wrong[2].turn = {{{1e9f, 0}, {0, 0.1f}}};
    constexpr std::array<std::uint32_t, 3> kWrong{0, 1, 2};
    const WaysNearby nonsense{wrong, {}, kWrong}, usualNonsense{wrong, kWrong, kWrong};
    // Four chains: through two faces, through the upper or the lower one as if the other were not there, and one
    // through a side.
    for (const WaysNearby& ways :
         {WaysNearby{}, known, noneUsual, noneOthers, exchanged, nonsense, usualNonsense}) {
        expectChains(*scene, lamp, 2, 4, 20000, ways);
    }
    // The same way twice leads to one chain.
    RayTally tally;
    const std::array<std::uint32_t, 2> twice{known.usual[0], known.usual[0]};
    const ChainQuery query{floorOf(*scene), lamp, 2};
    EXPECT_EQ(WayFollower(*scene).usual(query, {known.all, twice, {}}, tally).size(), 1u);
}

/// Searches that know ways find as much as others. Almost everywhere, usual ways give at least one chain for certain.
TEST(ChainSeeds, areWaysThatLightComes) {
    const auto scene = litThroughGlass().build();
    const ThreadPool threads(2);
    const ChainSeeds seeds(*scene, threads);
    const ChainSearch search(*scene);
    const ChainTarget targets[] = {{normalize(Vec3{0.2f, 0.9f, 0.1f}), true},
                                   lampAt(*scene, {0.3, 2, 0.2})};
    RayTally tally;
    Rng rng(6, 0, StreamKind::User, 0);
    for (const std::uint32_t light : {0u, 1u}) {
        Moments alone, with;
        int sure = 0;
        for (int i = 0; i < 4000; ++i) {
            ChainStart start = floorOf(*scene);
            start.position =
                start.position + Vec3{rng.uniform() - 0.5f, 0, rng.uniform() - 0.5f} * 0.4f;
            const ChainQuery query{start, targets[light], 2};
            const WaysNearby near = seeds.near(light, start.position, {0, 1, 0});
            alone.add(worthOf(search, query, {}, rng));
            with.add(worthOf(search, query, near, rng));
            sure += search.follower().usual(query, near, tally).empty() ? 0 : 1;
        }
        EXPECT_LT(std::fabs(alone.mean() - with.mean()),
                  5 * std::hypot(alone.standardError(), with.standardError()));  // 6e-7 by chance
        EXPECT_GT(sure, 3800);
    }
}

/// The direction of a known way, turned for a place nearby, is close to the exact one: with curved and flat glass, for
/// lamps and the sun.
TEST(ChainSeeds, turnWithThePlace) {
    SceneBuilder b = litThroughGlass();
    lacuna::Material clear = glass(1.5f);
    b.add(ball({-1.2f, 0.8f, 0.3f}, 0.4f, b.add(clear)));
    const auto scene = b.build();
    const ThreadPool threads(2);
    const ChainSeeds seeds(*scene, threads);
    const WayFollower follower(*scene);
    const ChainTarget targets[] = {{normalize(Vec3{0.2f, 0.9f, 0.1f}), true},
                                   lampAt(*scene, {0.3, 2, 0.2})};
    Rng rng(7, 0, StreamKind::User, 0);
    RayTally tally;
    for (const std::uint32_t light : {0u, 1u}) {
        int better = 0, turned = 0;
        for (int i = 0; i < 2000; ++i) {
            ChainStart start = floorOf(*scene);
            const float x = 3 * rng.uniform() - 2, z = 2 * rng.uniform() - 1;
            const Vec3 place = start.position + Vec3{x, 0, z};
            const WaysNearby near = seeds.near(light, place, {0, 1, 0});
            if (near.usual.empty()) continue;
            const ChainSeed& way = near.all[near.usual[0]];
            if (way.end.y > start.position.y + 1e-3f) continue;
            start.position = way.end + Vec3{0.004f * rng.uniform(), 0, 0.004f};
            const auto found =
                follower.followUsual(way, {start, targets[light], Chain::kMost}, tally);
            if (!found) continue;
            const Vec3d& exact = found->chain.firstDirection();
            const double by = length(Vec3d(way.direction) - exact);
            if (by < 1e-4 || by > 0.02) continue;  // as good as straight, or near a focus
            ++turned;
            better += length(way.directionAt(Vec3d(start.position)) - exact) < 0.25 * by ? 1 : 0;
        }
        EXPECT_GT(turned, 50) << "light " << light;
        EXPECT_GT(better, 0.8 * turned) << "light " << light << ", of " << turned;
    }
}

bool areAlike(const ChainSeed& a, const ChainSeed& b) {
    return a.size == b.size && a.events == b.events && dot(a.direction, b.direction) > 0.98f;
}

constexpr std::size_t kHere = 16;  // the first of `others`: ways that came here

/// Ways like every usual one came here, and no way is listed twice.
TEST(ChainSeeds, comeInKinds) {
    const auto scene = litThroughGlass().build();
    const ThreadPool threads(2);
    const ChainSeeds seeds(*scene, threads);
    Rng rng(7, 0, StreamKind::User, 0);
    int severalUsual = 0, fromAround = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec3 place =
            floorOf(*scene).position + Vec3{rng.uniform() - 0.5f, 0, rng.uniform() - 0.5f} * 0.8f;
        const WaysNearby ways = seeds.near(1, place, {0, 1, 0});
        ASSERT_FALSE(ways.usual.empty());
        severalUsual += ways.usual.size() > 1 ? 1 : 0;
        fromAround += ways.others.size() > kHere ? 1 : 0;
        ASSERT_GE(ways.others.size(), kHere);
        for (const std::uint32_t usual : ways.usual) {
            const auto isLike = [&](std::uint32_t other) {
                return areAlike(ways.all[usual], ways.all[other]);
            };
            EXPECT_GE(std::ranges::count_if(ways.others.first(kHere), isLike), 1);
        }
        for (const auto& some : {ways.usual, ways.others}) {
            for (const std::uint32_t way : some) EXPECT_EQ(std::ranges::count(some, way), 1);
        }
    }
    EXPECT_GT(severalUsual, 20);
    EXPECT_GT(fromAround, 100);
}

/// Ways to lamps are usual only if they came twice, because each sample follows all of them.
TEST(ChainSeeds, comeMoreThanOnceToLamps) {
    SceneBuilder b = litThroughGlass();
    b.add(quad({0.3f, 2, 0.2f}, {0.02f, 0, 0}, {0, 0, 0.02f}, b.add(emitter(Rgb(1)))));
    const auto scene = b.build();
    const ThreadPool threads(2);
    const ChainSeeds seeds(*scene, threads);
    Rng rng(9, 0, StreamKind::User, 0);
    int kinds = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec3 place =
            floorOf(*scene).position + Vec3{rng.uniform() - 0.5f, 0, rng.uniform() - 0.5f} * 0.8f;
        const WaysNearby ways = seeds.nearOfLamps(place, {0, 1, 0});
        for (const std::uint32_t usual : ways.usual) {
            const auto isLike = [&](std::uint32_t other) {
                return areAlike(ways.all[usual], ways.all[other]);
            };
            EXPECT_GE(std::ranges::count_if(ways.others.first(kHere), isLike), 2);
            ++kinds;
        }
    }
    EXPECT_GT(kinds, 200);
}

/// Under a slab, the strength is what two faces transmit, relative to the whole power over the sphere around the scene.
/// The sun's power falls on a disk, the lamp's goes in all directions, and the spot's into a cone.
TEST(ChainSeeds, areAsStrongAsTheLightThatComes) {
    SceneBuilder b;
    b.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, b.add(matte(Rgb(0.5f)))));
    b.add(box({-2, 0.5f, -2}, {2, 0.6f, 2}, b.add(glass(1.5f))));
    b.add(directionalLight({0, -1, 0}, Rgb(1)));
    b.add(pointLight({0, 3, 0}, Rgb(1)));
    // The spot has the lamp's power, so that as many rays leave it.
    b.add(spotLight({0, 3, 0}, {0, -1, 0}, Rgb(100), 0.199, 0.2));
    const auto scene = b.build();
    const ThreadPool threads(2);
    const ChainSeeds seeds(*scene, threads);
    Rng rng(8, 0, StreamKind::User, 0);
    const double faces = 0.96 / 1.04;  // with all reflections within the slab
    const double radius = scene->radius();
    const double ofAllDirections = 0.5 * (1 - std::cos(0.2));  // share that the spot's cone has
    const double ofLamp = faces * radius * radius / 9;
    const double expected[] = {4 * faces, ofLamp, ofLamp / ofAllDirections};
    for (const std::uint32_t light : {0u, 1u, 2u}) {
        Moments strength;
        for (int i = 0; i < 400; ++i) {
            const Vec3 beside{0.3f * (rng.uniform() - 0.5f), 0, 0.3f * (rng.uniform() - 0.5f)};
            strength.add(seeds.near(light, floorOf(*scene).position + beside, {0, 1, 0}).strength);
        }
        // The ways of a window fill a part of its disk: 2 / pi for a square patch, and less for two patches.
        EXPECT_GT(strength.mean() / expected[light], 0.4) << "light " << light;
        EXPECT_LT(strength.mean() / expected[light], 1.0) << "light " << light;
    }
}

/// Ways belong to the light that is asked for, and to one side of a thin sheet.
TEST(ChainSeeds, knowSidesAndLights) {
    const auto scene = litThroughGlass().build();
    const ThreadPool threads(1);
    const ChainSeeds seeds(*scene, threads);
    for (const float up : {1.0f, -1.0f}) {
        const Vec3 sheet = Vec3(Vec3d{10.1, 0.001 * double(up), 0.2} - scene->centre());
        for (const std::uint32_t light : {2u, 3u}) {
            // Each lamp shines on one face.
            const bool shines = (light == 2) == (up > 0);
            const WaysNearby ways = seeds.near(light, sheet, {0, up, 0});
            const auto isHere = [&](std::uint32_t way) {
                const ChainSeed& seed = ways.all[way];
                return length(seed.end - sheet) < 0.5f && seed.direction.y * up > 0;
            };
            const auto here = ways.others.first(kHere);
            EXPECT_EQ(std::ranges::count_if(here, isHere), shines ? kHere : 0)
                << "light " << light << ", side " << up;
            EXPECT_EQ(std::ranges::count_if(ways.usual, isHere) > 0, shines);
            EXPECT_TRUE(shines || std::ranges::count_if(ways.others, isHere) == 0);
        }
    }
    SceneBuilder noGlass;
    noGlass.add(quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, noGlass.add(matte(Rgb(0.5f)))));
    noGlass.add(pointLight({0, 1, 0}, Rgb(1)));
    EXPECT_TRUE(ChainSeeds(*noGlass.build(), threads).near(0, {}, {0, 1, 0}).all.empty());
}

/// A convex mirror shows a lamp once from anywhere.
TEST(ChainSearch, findsTheImageInABall) {
    SceneBuilder b;
    b.add(ball({0, 2, 0}, 1, b.add(mirror())));
    const auto scene = b.build();
    expectChains(*scene, lampAt(*scene, {2, 2.5, 0.5}), 1, 1, 6000);
}

/// Newton's method moves a chain's vertices from one face of a block to the next. A ray that leaves a flat face does
/// not meet it again: two reflections there would let it pass as if there were no glass.
TEST(ChainSearch, leavesEachFaceItMeets) {
    SceneBuilder b;
    b.add(box({-0.4f, 0.01f, -0.4f}, {0.4f, 2, 0.4f}, b.add(glass(1.5f))), rotation({0, 1, 0}, 24));
    const auto scene = b.build();
    const ChainSearch search(*scene);
    ChainQuery query{floorOf(*scene), {normalize(Vec3{0.45f, 0.82f, 0.37f}), true}, 4};
    const Vec3 middle = query.start.position;
    Rng rng(4, 0, StreamKind::User, 0);
    int edges = 0;
    for (int i = 0; i < 200000; ++i) {
        query.start.position = middle + Vec3{rng.uniform() - 0.5f, 0, rng.uniform() - 0.5f};
        const auto found = oneOf(search, query, rng);
        for (std::size_t k = 1; found && k < found->chain.size(); ++k, ++edges) {
            EXPECT_NE(found->chain[k].hit.primitive, found->chain[k - 1].hit.primitive);
        }
    }
    EXPECT_GT(edges, 1000);
}

/// A plane mirror's spread is that of the straight way to the lamp's image.
TEST(ChainSearch, knowsTheDistanceToAnImage) {
    SceneBuilder b;
    b.add(quad({-1, -50, 50}, {0, 0, -100}, {0, 100, 0}, b.add(mirror())));
    const auto scene = b.build();
    const ChainSearch search(*scene);
    const ChainStart start = floorOf(*scene);
    const ChainTarget lamp = lampAt(*scene, {0.3, 1.5, 0.2});
    const Vec3d to{-2.3, 1.5, 0.2};  // the lamp's image
    Rng rng(3, 0, StreamKind::User, 0);
    for (int i = 0; i < 100; ++i) {
        const auto found = oneOf(search, {start, lamp, 1}, rng);
        if (!found) continue;
        EXPECT_NEAR(found->spread * lengthSquared(to), 1.0, 1e-6);
        EXPECT_LT(length(found->chain.firstDirection() - normalize(to)), 1e-6);
        return;
    }
    FAIL() << "nothing found in 100 searches";
}

std::optional<FoundChain> throughGlass(const ChainSolver& solver, const ChainQuery& query,
                                       RayTally& tally) {
    const Vec3d straight = normalize(query.target.wayFrom(Vec3d(query.start.position)));
    return solver.throughGlass(query, straight, tally);
}

/// A chain through both faces of a slab obeys Snell's law: where the ray leaves, and how it spreads.
TEST(ChainSolver, goesThroughASlabByItself) {
    SceneBuilder b;
    b.add(box({-50, 1, -50}, {50, 1.5f, 50}, b.add(glass(1.5f))));
    const auto scene = b.build();
    const ChainSolver solver(*scene);
    const ChainStart start = floorOf(*scene);
    RayTally tally;
    const auto sideways = [](double sine) {  // 2 of air and .5 of glass
        const double inside = sine / 1.5;
        return 2 * sine / std::sqrt(1 - sine * sine) +
               0.5 * inside / std::sqrt(1 - inside * inside);
    };
    for (const double x : {0.1, 1.0, 3.0, 8.0}) {
        const ChainTarget lamp = lampAt(*scene, {x, 2.5, 0});
        const auto found = throughGlass(solver, {start, lamp, Chain::kMost}, tally);
        ASSERT_TRUE(found) << x;
        EXPECT_EQ(found->chain.size(), 2u);
        const Vec3d along = found->chain.firstDirection();
        EXPECT_NEAR(sideways(along.x), x, 1e-4 * x);
        // sin d(sin) / cos over the ring's area at the lamp, as seen along the ray.
        const double sine = along.x, cosine = along.y, by = 1e-5;
        const double ring = (sideways(sine + by) - sideways(sine - by)) / (2 * by);
        EXPECT_NEAR(found->spread * x * ring * cosine * cosine / sine, 1.0, 1e-3);
        EXPECT_TRUE(solver.isAlong(*found, {start, lamp, Chain::kMost}, along, 1e-3, tally));
        const Vec3d straight = normalize(Vec3d{x, 2.5, 0});
        EXPECT_FALSE(solver.isAlong(*found, {start, lamp, Chain::kMost}, straight, 1e-4, tally));
    }
    // A target at infinity is seen in its own direction.
    const ChainTarget sky{normalize(Vec3{0.3f, 0.8f, 0.2f}), true};
    const auto found = throughGlass(solver, {start, sky, Chain::kMost}, tally);
    ASSERT_TRUE(found);
    EXPECT_LT(length(found->chain.firstDirection() - Vec3d(sky.position)), 1e-6);
    EXPECT_NEAR(found->spread, 1.0, 1e-6);
    // No glass is on the way to a lamp below the slab, and no way leads through a mirror.
    EXPECT_FALSE(throughGlass(solver, {start, lampAt(*scene, {1, 0.5, 0}), Chain::kMost}, tally));
    SceneBuilder shut;
    shut.add(box({-50, 1, -50}, {50, 1.5f, 50}, shut.add(mirror())));
    const auto closed = shut.build();
    EXPECT_FALSE(throughGlass(ChainSolver(*closed), {floorOf(*closed), sky, Chain::kMost}, tally));
}

/// A ray along the axis of a glass ball is not bent. Rays near it are moved and turned in proportion to their distance
/// from it. The two faces in turn give the spread at the lamp, or in the sky.
TEST(ChainSolver, knowsTheLensThatABallIs) {
    constexpr double kIndex = 1.5, kRadius = 0.5, kBefore = 1.5;  // from the start to the centre
    constexpr double kPower = (kIndex - 1) / kRadius;             // of either face
    const Vec3d axis = normalize(Vec3d{0.6, 0.7, 0.4});  // through no pole of the triangles
    SceneBuilder b;
    b.add(ball(Vec3(axis * kBefore), float(kRadius), b.add(glass(float(kIndex))), 400));
    const auto scene = b.build();
    const ChainSolver solver(*scene);
    const ChainStart start = floorOf(*scene);
    // For a ray that leaves the start at an angle of one to the axis.
    const double meets = kBefore - kRadius;
    const double inside = (1 - kPower * meets) / kIndex;
    const double leaves = meets + 2 * kRadius * inside;
    const double turned = kIndex * inside - kPower * leaves;
    const double reflected = std::pow((kIndex - 1) / (kIndex + 1), 2);
    RayTally tally;
    const auto expectOnAxis = [&](const ChainTarget& target, double apart) {
        const auto found = throughGlass(solver, {start, target, Chain::kMost}, tally);
        ASSERT_TRUE(found) << apart;
        ASSERT_EQ(found->chain.size(), 2u);
        EXPECT_LT(length(found->chain.firstDirection() - axis), 1e-4);
        EXPECT_NEAR(found->spread * apart * apart, 1.0, 1e-2) << apart;
        const Rgb through = found->chain[0].through * found->chain[1].through;
        EXPECT_NEAR(double(mean(through)), (1 - reflected) * (1 - reflected), 1e-4);
    };
    // Lamps before, near and behind the point where the ball focuses the start's rays, 1.5 behind its centre.
    for (const double behind : {0.6, 1.0, 1.4, 1.6, 2.0, 4.0, 20.0}) {
        const Vec3d lamp = axis * (kBefore + behind);
        expectOnAxis(lampAt(*scene, lamp), leaves + (behind - kRadius) * turned);
    }
    expectOnAxis({Vec3(axis), true}, turned);
}

/// From under water, the straight way to a low sun would be reflected back. The chain found obeys Snell's law.
TEST(ChainSolver, turnsWhatWouldBeReflectedBack) {
    SceneBuilder b;
    b.add(box({-50, -0.5f, -50}, {50, 1, 50}, b.add(glass(1.33f))));
    const auto scene = b.build();
    RayTally tally;
    const ChainTarget sun{normalize(Vec3{3, 1, 0}), true};
    const auto found =
        throughGlass(ChainSolver(*scene), {floorOf(*scene), sun, Chain::kMost}, tally);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->chain.size(), 1u);
    EXPECT_NEAR(found->chain.firstDirection().x, double(sun.position.x) / 1.33, 1e-6);
}

/// Glass with alpha is left out, even if only Newton's method reaches it. The straight way to the lamp meets the slab
/// at x = 1, and the solution lies beyond 1.05, where alpha begins.
TEST(ChainSolver, goesThroughNoAlphaThatItComesTo) {
    for (const bool veiled : {false, true}) {
        SceneBuilder b;
        const auto clear = b.add(glass(1.5f));
        lacuna::Material veil = glass(1.5f);
        if (veiled) veil.alphaMode = lacuna::Material::Alpha::Blend;
        b.add(quad({-50, 1.5f, 50}, {100, 0, 0}, {0, 0, -100}, clear));
        b.add(quad({-50, 1, -50}, {51.05f, 0, 0}, {0, 0, 100}, clear));
        b.add(quad({1.05f, 1, -50}, {48.95f, 0, 0}, {0, 0, 100}, b.add(veil)));
        const auto scene = b.build();
        const ChainQuery query{floorOf(*scene), lampAt(*scene, {3, 3, 0}), Chain::kMost};
        RayTally tally;
        const auto found = throughGlass(ChainSolver(*scene), query, tally);
        ASSERT_EQ(found.has_value(), !veiled);
        if (veiled) continue;
        EXPECT_GT(double(found->chain[0].point.position.x) + scene->centre().x, 1.05);
    }
}

/// A glass ball shows a lamp near its focus several times. The sign of the spread tells two images apart, however near
/// they are.
TEST(ChainSolver, tellsImagesOnEitherSideOfAFoldApart) {
    SceneBuilder b;
    b.add(ball({0, 1.5f, 0}, 0.5f, b.add(glass(1.5f))));
    const auto scene = b.build();
    const ChainSearch search(*scene);
    const ChainSolver solver(*scene);
    const ChainQuery query{floorOf(*scene), lampAt(*scene, {0.02, 2.6, 0.01}), 2};
    const auto signOf = [](const FoundChain& found) {
        const auto& [a, c] = found.missBy;
        return a[0] * c[1] - a[1] * c[0] > 0;
    };
    RayTally tally;
    Rng rng(5, 0, StreamKind::User, 0);
    std::vector<FoundChain> images;
    for (int i = 0; i < 400; ++i) {
        const auto found = oneOf(search, query, rng);
        const bool refracts =
            found && found->chain.size() == 2 &&
            found->chain[0].event == SpecularEvent{ScatterEvent::DeltaTransmission} &&
            found->chain[1].event == SpecularEvent{ScatterEvent::DeltaTransmission};
        if (refracts) images.push_back(*found);
    }
    int alike = 0, different = 0;
    for (const FoundChain& one : images) {
        for (const FoundChain& other : images) {
            const bool same = signOf(one) == signOf(other);
            (same ? alike : different) += 1;
            const Vec3d& along = other.chain.firstDirection();
            EXPECT_EQ(solver.isAlong(one, query, along, 3.0, tally), same);
        }
    }
    EXPECT_GT(alike, 0);
    EXPECT_GT(different, 0);
}

/// Rays that meet glass pass through the boxes, and most others do not.
TEST(GlassBoxes, holdAllGlass) {
    SceneBuilder b;
    const auto mesh = b.add(ball({0, 0, 0}, 1, b.add(glass(1.4f))));
    b.instance(mesh, translation({9, 1, 0}) * scaling({1, 2, 0.5}));
    b.add(box({-2, 3, -9}, {-1, 3.01f, 9}, 1));
    b.add(quad({-20, -5, 20}, {40, 0, 0}, {0, 0, -40}));
    lacuna::Material veil = glass();
    veil.alphaMode = lacuna::Material::Alpha::Blend;
    b.add(ball({0, 9, 0}, 2, b.add(veil)));
    const auto scene = b.build();
    const GlassBoxes glass(glassInBoxes(*scene));
    RayTally tally;
    Rng rng(4, 0, StreamKind::User, 0);
    int hits = 0, others = 0;
    for (int n = 0; n < 20000; ++n) {
        const auto point = [&] {
            return Vec3{rng.uniform() * 24 - 12, rng.uniform() * 12 - 4, rng.uniform() * 24 - 12};
        };
        const Vec3 origin = point(), way = n % 7 == 0 ? Vec3{1, 0, 0} : point() - origin;
        const auto hit = scene->trace(origin, {}, way, RayKind::Chain, tally);
        bool meets = false;
        if (hit) {
            SurfacePoint at;
            scene->surfaceAt(*hit, at);
            meets = at.material == 1;
        }
        if (meets) {
            ++hits;
            EXPECT_TRUE(glass.mayLieOn(origin, way, true));
            if (hit->distance < 1) {
                EXPECT_TRUE(glass.mayLieOn(origin, way, false));
            }
        }
        others += !glass.mayLieOn(origin, way, true);
    }
    EXPECT_GT(hits, 300);
    EXPECT_GT(others, 10000);
}

}  // namespace
}  // namespace lacuna::test

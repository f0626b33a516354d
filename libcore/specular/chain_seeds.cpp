#include "libcore/specular/chain_seeds.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "libcore/specular/triangles_by_area.h"

namespace lacuna {

namespace {

constexpr double kRays = 32768;  // of all lights
constexpr std::size_t kRaysPerTask = 512;
constexpr std::size_t kNear = 16;  // seeds that a place has
constexpr int kBits = 9;           // of a code, for each coordinate
constexpr float kAlike = 0.98f;    // cosine between ways of one kind

/// Where a way ended, and the way.
struct Arrival {
    Vec3 side;  ///< of the surface
    ChainSeed seed;
};

ChainSeed backwards(const Chain& chain, const Vec3& end) {
    ChainSeed seed;
    seed.end = end;
    seed.towards = chain[chain.size() - 1].point.position;
    for (std::size_t i = chain.size(); i-- > 0;) seed.events[seed.size++] = chain[i].event;
    return seed;
}

/// One ray of the light towards `at`, and what it leads to: wherever something scatters it.
void followRay(const ChainSolver& solver, std::uint32_t light, const Vec3& at, Rng& rng,
               std::vector<Arrival>& arrivals) {
    const Scene& scene = solver.scene();
    const LightPoint from = scene.lights().punctualPoint(light);
    const bool infinite = isInfinite(from.kind);
    const Vec3 origin = infinite ? at + from.position * (2 * scene.radius()) : from.position;
    const Vec3d way = infinite ? -Vec3d(from.position) : Vec3d(at) - Vec3d(origin);
    if (!(lengthSquared(way) > 0.0)) return;
    const Vec3d direction = normalize(way);
    if (!(scene.lights().profile(light, from.ng, Vec3(direction)) > 0.0f)) return;
    Chain chain(MovingRay::from(Vec3d(origin), direction));
    const ChainStart start{origin, {}, {}};
    RayTally ignored;
    while (const std::optional<Hit> hit = solver.next(start, chain, ignored)) {
        if (chain.size() > 0) {
            SurfacePoint point;
            scene.surfaceAt(*hit, point);
            if (scene.bsdfAt(point).connectable()) {
                const bool front = dot(Vec3d(point.ng), chain.last().direction) < 0.0;
                const Vec3 side = front ? point.ng : -point.ng;
                arrivals.push_back({side, backwards(chain, point.position)});
            }
        }
        if (!chain.extend(scene, *hit, rng.uniformDouble())) return;
    }
}

/// Every third bit.
std::uint32_t spread(std::uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

}  // namespace

ChainSeeds::ChainSeeds(const Scene& scene, const ThreadPool& threads) {
    const Lights& lights = scene.lights();
    double power = 0.0;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        if (!isHittable(lights.kind(i))) power += lights.powerShare(i);
    }
    if (!(power > 0.0)) return;
    const TrianglesByArea triangles(scene.trianglesOf(mayBeSpecular));
    if (triangles.empty()) return;
    const Vec3 half = scene.halfSize();
    half_ = std::max({half.x, half.y, half.z});
    byLight_.resize(lights.size());
    const ChainSolver solver(scene);
    for (std::uint32_t light = 0; light < lights.size(); ++light) {
        if (isHittable(lights.kind(light))) continue;
        const auto rays = std::size_t(std::ceil(kRays * lights.powerShare(light) / power));
        std::vector<std::vector<Arrival>> found((rays + kRaysPerTask - 1) / kRaysPerTask);
        threads.forEach(found.size(), [&](std::size_t task) {
            const std::size_t end = std::min(rays, (task + 1) * kRaysPerTask);
            for (std::size_t i = task * kRaysPerTask; i < end; ++i) {
                Rng rng(0, light, StreamKind::Chain, ~std::uint64_t(i));
                const Vec3 at = triangles.sample(rng).position;
                followRay(solver, light, at, rng, found[task]);
            }
        });
        std::vector<std::pair<std::uint32_t, const ChainSeed*>> byCode;
        for (const auto& arrivals : found) {
            for (const Arrival& a : arrivals) {
                byCode.emplace_back(codeOf(a.seed.end, a.side), &a.seed);
            }
        }
        std::ranges::stable_sort(byCode, {}, [](const auto& pair) { return pair.first; });
        for (const auto& [code, seed] : byCode) {
            byLight_[light].codes.push_back(code);
            byLight_[light].seeds.push_back(*seed);
        }
        const std::span<const ChainSeed> seeds = byLight_[light].seeds;
        const std::size_t most = std::min(kNear, seeds.size());
        byLight_[light].kinds.resize(seeds.size() - most + 1);
        threads.forEach(byLight_[light].kinds.size(), [&](std::size_t first) {
            byLight_[light].kinds[first] = kindsOf(seeds.subspan(first, most));
        });
    }
}

/// Ways are of a kind by their events and by where they come from; the one in the middle stands for it.
ChainSeeds::Kinds ChainSeeds::kindsOf(std::span<const ChainSeed> ways) {
    struct Kind {
        std::uint8_t place;
        Vec3 direction;
        int count;
    };
    const auto fromMiddle = [&](std::size_t place) {
        return std::abs(int(place) - int(ways.size() / 2));
    };
    std::array<Kind, kNear> kinds;
    std::size_t size = 0;
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const ChainSeed& way = ways[i];
        const Vec3 direction = normalize(way.towards - way.end);
        const auto end = kinds.begin() + std::ptrdiff_t(size);
        const auto kind = std::find_if(kinds.begin(), end, [&](const Kind& k) {
            const ChainSeed& other = ways[k.place];
            return other.size == way.size && other.events == way.events &&
                   dot(k.direction, direction) > kAlike;
        });
        if (kind == end) {
            kinds[size++] = {std::uint8_t(i), direction, 1};
        } else {
            ++kind->count;
            if (fromMiddle(i) < fromMiddle(kind->place)) kind->place = std::uint8_t(i);
        }
    }
    const std::span found = std::span(kinds).first(size);
    std::ranges::stable_sort(found, std::ranges::greater(), &Kind::count);
    Kinds often;
    for (const Kind& kind : found) {
        if (kind.count < 2 || often.size == often.places.size()) break;
        often.places[often.size++] = kind.place;
    }
    return often;
}

/// The axis that the side lies nearest to, then a Morton code: what is near in these is mostly near in
/// space, and on one side of a sheet.
std::uint32_t ChainSeeds::codeOf(const Vec3& place, const Vec3& side) const {
    const Vec3 size{std::fabs(side.x), std::fabs(side.y), std::fabs(side.z)};
    const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    const float along = axis == 0 ? side.x : axis == 1 ? side.y : side.z;
    const auto cell = [this](float x) {
        constexpr float kCells = 1 << kBits;
        return std::uint32_t(std::clamp((x / half_ + 1.0f) * (kCells / 2), 0.0f, kCells - 1.0f));
    };
    return std::uint32_t(2 * axis + (along < 0.0f ? 1 : 0)) << (3 * kBits) | spread(cell(place.x)) |
           spread(cell(place.y)) << 1 | spread(cell(place.z)) << 2;
}

WaysNearby ChainSeeds::near(std::uint32_t light, const Vec3& place, const Vec3& side) const {
    if (byLight_.empty() || byLight_[light].seeds.empty()) return {};
    const OfLight& of = byLight_[light];
    const std::size_t most = std::min(kNear, of.seeds.size());
    const auto at =
        std::size_t(std::ranges::lower_bound(of.codes, codeOf(place, side)) - of.codes.begin());
    const std::size_t first = std::min(at - std::min(at, kNear / 2), of.seeds.size() - most);
    const Kinds& kinds = of.kinds[first];
    return {std::span(of.seeds).subspan(first, most), std::span(kinds.places).first(kinds.size)};
}

}  // namespace lacuna

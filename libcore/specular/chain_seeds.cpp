// (theory.md, "Specular chains", "Next event along known ways")
#include "libcore/specular/chain_seeds.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "libcore/specular/triangles_by_area.h"

namespace lacuna {

namespace {

constexpr double kRays = 32768;  // of all lights
constexpr std::size_t kRaysPerTask = 512;
constexpr std::size_t kDraws = 16;     // at most, until a light shines that way
constexpr std::size_t kNear = 16;      // ways that are near a place
constexpr std::size_t kAround = 1024;  // ways that are farther around
constexpr std::size_t kStep = 256;     // successive windows that share the ways farther around
constexpr int kBits = 9;               // of a code, for each coordinate
constexpr double kFewTimes = 10.0;  // a way to a lamp is kept if walks are so many times as seldom
constexpr float kAlike = 0.98f;     // cosine between ways of one kind

/// The axes across a direction that ChainSeed::turn is in.
std::array<Vec3d, 2> axesOf(const Vec3& direction) {
    return MovingRay::from({}, Vec3d(direction)).directionBy;
}

/// How the direction back along a ray turns with the place where the ray ends, at `distance` from its origin, by ray
/// differentials. Not finite where the rays about it meet.
std::array<std::array<float, 2>, 2> turnOf(const MovingRay& ray, double distance,
                                           const std::array<Vec3d, 2>& axes) {
    Jacobian end, turn;  // by the ray's two parameters
    for (std::size_t c = 0; c < 2; ++c) {
        for (std::size_t i = 0; i < 2; ++i) {
            turn[c][i] = -dot(axes[c], ray.directionBy[i]);
            end[c][i] = dot(axes[c], ray.originBy[i]) - distance * turn[c][i];
        }
    }
    const double determinant = end[0][0] * end[1][1] - end[0][1] * end[1][0];
    const auto row = [&](const std::array<double, 2>& t) -> std::array<float, 2> {
        return {float((t[0] * end[1][1] - t[1] * end[1][0]) / determinant),
                float((t[1] * end[0][0] - t[0] * end[0][1]) / determinant)};
    };
    return {row(turn[0]), row(turn[1])};
}

ChainSeed backwards(const Chain& chain, const Vec3& end, double strength) {
    ChainSeed seed;
    seed.strength = float(strength);
    seed.end = end;
    // Not the difference of two points, which may lie a millimetre apart.
    seed.direction = Vec3(-chain.last().direction);
    const double distance = length(Vec3d(end) - chain.last().origin);
    seed.distance = float(distance);
    seed.turn = turnOf(chain.last(), distance, axesOf(seed.direction));
    for (std::size_t i = chain.size(); i-- > 0;) seed.events[seed.size++] = chain[i].event;
    return seed;
}

/// How many times as seldom an eye walk from a surface at this distance hits the point of a lamp or a sky as the point
/// is drawn there: the ratio of the two densities.
double timesAsSeldom(const LightPoint& from, const Vec3& direction, double distance) {
    const double pdfW = isInfinite(from.kind)
                            ? double(from.pdf)
                            : double(from.pdf) * distance * distance /
                                  std::max(1e-3, std::fabs(double(dot(from.ng, direction))));
    return kPi * pdfW;
}

/// Whether next event through glass makes this way's paths: the straight ray from its end to the light
/// leads to its chain.
bool isStraightOn(const ChainSolver& solver, const Chain& chain, const SurfacePoint& end,
                  const LightPoint& from) {
    for (std::size_t i = 0; i < chain.size(); ++i) {
        if (chain[i].event.event != ScatterEvent::DeltaTransmission) return false;
    }
    const ChainQuery query{
        {end.position, end.ng, {}}, {from.position, isInfinite(from.kind)}, Chain::kMost};
    const Vec3d straight = query.target.wayFrom(Vec3d(end.position));
    RayTally ignored;
    const auto found = solver.throughGlass(query, normalize(straight), ignored);
    constexpr double kAngle = 1e-3;
    return found && found->chain.size() == chain.size() &&
           length(found->chain.firstDirection() + chain.last().direction) < kAngle;
}

/// Spreads the bits of x to every third bit.
std::uint32_t spread(std::uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

}  // namespace

Vec3d ChainSeed::directionAt(const Vec3d& place) const {
    const Vec3d straight(direction), apart = place - Vec3d(end);
    const std::array<Vec3d, 2> axes = axesOf(direction);
    const double u = dot(axes[0], apart), v = dot(axes[1], apart);
    const double x = double(turn[0][0]) * u + double(turn[0][1]) * v;
    const double y = double(turn[1][0]) * u + double(turn[1][1]) * v;
    constexpr double kMost = 1.0;  // radians: what is known of a point says nothing so far away
    if (!(std::hypot(x, y) < kMost)) return straight;
    return normalize(straight + axes[0] * x + axes[1] * y);
}

bool ChainSeed::hasEventsOf(const Chain& chain) const {
    if (size != chain.size()) return false;
    for (std::size_t i = 0; i < size; ++i) {
        if (!(events[i] == chain[i].event)) return false;
    }
    return true;
}

/// Follows one ray of a light. Adds an arrival wherever something scatters the ray.
void ChainSeeds::followRay(const ChainSolver& solver, const LightPoint& from, const Ray& ray,
                           Rng& rng, std::vector<Arrival>& arrivals) {
    const Scene& scene = solver.scene();
    Chain chain(isInfinite(from.kind) ? MovingRay::parallel(Vec3d(ray.origin), ray.direction)
                                      : MovingRay::from(Vec3d(ray.origin), ray.direction));
    const ChainStart start{ray.origin, from.ng, {}};
    RayTally ignored;
    double distance = 0.0;
    while (const std::optional<Hit> hit = solver.next(start, chain, ignored)) {
        distance += double(hit->distance);
        if (chain.size() > 0) {
            SurfacePoint point;
            scene.surfaceAt(*hit, point);
            if (scene.bsdfAt(point).connectable()) {
                double strength = ray.power;
                bool isLeft = true;
                if (isHittable(from.kind)) {
                    const double times = timesAsSeldom(from, Vec3(ray.direction), distance);
                    strength *= std::sqrt(times);
                    isLeft = times > kFewTimes && !isStraightOn(solver, chain, point, from);
                }
                const bool front = dot(Vec3d(point.ng), chain.last().direction) < 0.0;
                const Vec3 side = front ? point.ng : -point.ng;
                if (isLeft) arrivals.push_back({side, backwards(chain, point.position, strength)});
            }
        }
        if (!chain.extend(scene, *hit, rng.uniformDouble())) return;
    }
}

ChainSeeds::ChainSeeds(const Scene& scene, const ThreadPool& threads) {
    const Lights& lights = scene.lights();
    double ofPoints = 0.0, ofLamps = 0.0;  // power
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        (isHittable(lights.kind(i)) ? ofLamps : ofPoints) += lights.powerShare(i);
    }
    if (lights.empty()) return;
    const TrianglesByArea triangles(scene.trianglesOf(mayBeSpecular));
    if (triangles.empty()) return;
    const Vec3 half = scene.halfSize();
    half_ = std::max({half.x, half.y, half.z});
    const double sphere = 4 * kPi * scene.radius() * scene.radius();
    const ChainSolver solver(scene);
    const auto rayTowards = [&](const TrianglesByArea::Point& at,
                                const LightPoint& from) -> std::optional<Ray> {
        const bool infinite = isInfinite(from.kind);
        const Vec3 origin =
            infinite ? at.position + from.position * (2 * scene.radius()) : from.position;
        const Vec3d way = infinite ? -Vec3d(from.position) : Vec3d(at.position) - Vec3d(origin);
        if (!(lengthSquared(way) > 0.0)) return std::nullopt;
        const Vec3d direction = normalize(way);
        const double profile = double(lights.profile(from.light, from.ng, Vec3(direction)));
        if (!(profile > 0.0)) return std::nullopt;
        const double cosine =
            from.kind == LightKind::Area ? std::fabs(dot(direction, Vec3d(from.ng))) : 1.0;
        const double disk = infinite ? kPi * scene.radius() * scene.radius() : lengthSquared(way);
        const double area =
            triangles.area() * std::fabs(dot(direction, Vec3d(triangles.normal(at.triangle))));
        return Ray{origin, direction, profile * cosine * area / disk};
    };
    // `pointOf` draws the point at which a ray leaves its light. Where a light shines on little of the glass, most
    // draws come to nothing, and cost little.
    const auto trace = [&](std::size_t rays, std::uint32_t stream, const UsualKinds& usual,
                           const auto& pointOf) {
        std::vector<std::vector<Arrival>> found((rays + kRaysPerTask - 1) / kRaysPerTask);
        std::vector<std::size_t> draws(found.size());
        threads.forEach(found.size(), [&](std::size_t task) {
            const std::size_t end = std::min(rays, (task + 1) * kRaysPerTask);
            for (std::size_t i = task * kRaysPerTask; i < end; ++i) {
                Rng rng(0, stream, StreamKind::Chain, ~std::uint64_t(i));
                for (std::size_t draw = 0; draw < kDraws; ++draw) {
                    ++draws[task];
                    const TrianglesByArea::Point at = triangles.sample(rng);
                    const LightPoint from = pointOf(rng);
                    const auto ray = rayTowards(at, from);
                    if (!ray) continue;
                    followRay(solver, from, *ray, rng, found[task]);
                    break;
                }
            }
        });
        const auto all = double(std::accumulate(draws.begin(), draws.end(), std::size_t{0}));
        for (auto& some : found) {
            for (Arrival& a : some) a.seed.strength *= float(sphere / all);
        }
        return sorted(found, usual, threads);
    };
    if (ofPoints > 0.0) byLight_.resize(lights.size());
    for (std::uint32_t light = 0; light < byLight_.size(); ++light) {
        if (isHittable(lights.kind(light))) continue;
        const auto rays = std::size_t(std::ceil(kRays * lights.powerShare(light) / ofPoints));
        byLight_[light] =
            trace(rays, light, kOfPoints, [&](Rng&) { return lights.punctualPoint(light); });
    }
    joinLights(lights);
    if (ofLamps > 0.0) {
        ofLamps_ = trace(std::size_t(kRays), std::uint32_t(lights.size()), kOfLamps,
                         [&](Rng& rng) { return lights.samplePoint(rng); });
    }
}

void ChainSeeds::joinLights(const Lights& lights) {
    const auto isKnown = [](const Sorted& ways) { return !ways.codes.empty(); };
    if (std::ranges::count_if(byLight_, isKnown) < 2) return;
    std::vector<std::pair<std::uint32_t, LightShare>> byCode;
    for (std::uint32_t light = 0; light < byLight_.size(); ++light) {
        const Sorted& ways = byLight_[light];
        const double share = lights.powerShare(light);
        for (std::size_t i = 0; i < ways.seeds.size(); ++i) {
            byCode.push_back(
                {ways.codes[i], {light, float(share * double(ways.seeds[i].strength))}});
        }
    }
    std::ranges::stable_sort(byCode, {}, [](const auto& pair) { return pair.first; });
    for (const auto& [code, share] : byCode) {
        codes_.push_back(code);
        shares_.push_back(share);
    }
}

ChainSeeds::Sorted ChainSeeds::sorted(std::span<const std::vector<Arrival>> arrivals,
                                      const UsualKinds& usual, const ThreadPool& threads) const {
    std::vector<std::pair<std::uint32_t, const ChainSeed*>> byCode;
    for (const auto& some : arrivals) {
        for (const Arrival& a : some) byCode.emplace_back(codeOf(a.seed.end, a.side), &a.seed);
    }
    std::ranges::stable_sort(byCode, {}, [](const auto& pair) { return pair.first; });
    Sorted ways;
    for (const auto& [code, seed] : byCode) {
        ways.codes.push_back(code);
        ways.seeds.push_back(*seed);
    }
    const std::span<const ChainSeed> seeds = ways.seeds;
    const std::size_t most = std::min(kNear, seeds.size());
    ways.windows.resize(seeds.size() - most + 1);
    const std::size_t mostAround = std::min(kAround, seeds.size());
    threads.forEach((ways.windows.size() + kStep - 1) / kStep, [&](std::size_t block) {
        const std::size_t begin = block * kStep;
        const std::size_t end = std::min(begin + kStep, ways.windows.size());
        const std::size_t before = std::min(begin, (kAround - kStep) / 2);
        const std::size_t first = std::min(begin - before, seeds.size() - mostAround);
        const std::vector<Kind> around = kindsOf(seeds, first, mostAround);
        for (std::size_t i = begin; i < end; ++i) {
            ways.windows[i] = windowOf(seeds, i, most, around, usual);
        }
    });
    return ways;
}

/// Whether a way is of this kind, by its events and by the direction that it comes from.
bool ChainSeeds::isOf(const Kind& kind, std::span<const ChainSeed> all, const ChainSeed& way) {
    const ChainSeed& own = all[kind.way];
    return own.size == way.size && own.events == way.events &&
           dot(kind.direction, way.direction) > kAlike;
}

/// The kinds of `size` ways from `first` on, the most frequent one first. The way nearest to the
/// middle stands for its kind.
std::vector<ChainSeeds::Kind> ChainSeeds::kindsOf(std::span<const ChainSeed> all, std::size_t first,
                                                  std::size_t size) {
    const auto fromMiddle = [&](std::size_t way) {
        return std::abs(std::ptrdiff_t(way) - std::ptrdiff_t(first + size / 2));
    };
    std::vector<Kind> kinds;
    for (std::size_t i = first; i < first + size; ++i) {
        const ChainSeed& way = all[i];
        const auto kind =
            std::ranges::find_if(kinds, [&](const Kind& k) { return isOf(k, all, way); });
        if (kind == kinds.end()) {
            kinds.push_back({std::uint32_t(i), way.direction, 1});
        } else {
            ++kind->count;
            if (fromMiddle(i) < fromMiddle(kind->way)) kind->way = std::uint32_t(i);
        }
    }
    std::ranges::stable_sort(kinds, std::ranges::greater(), &Kind::count);
    return kinds;
}

ChainSeeds::Window ChainSeeds::windowOf(std::span<const ChainSeed> all, std::size_t first,
                                        std::size_t size, std::span<const Kind> around,
                                        const UsualKinds& usual) {
    const std::span<const ChainSeed> ways = all.subspan(first, size);
    Window window;
    for (const ChainSeed& way : ways) window.centre += way.end * (1.0f / float(ways.size()));
    double strength = 0.0;
    for (const ChainSeed& way : ways) {
        window.radius = std::max(window.radius, length(way.end - window.centre));
        strength += double(way.strength);
    }
    window.strength = strength / (kPi * double(window.radius) * double(window.radius));
    const std::vector<Kind> here = kindsOf(all, first, size);
    const auto isHere = [&](const Kind& kind) {
        return std::ranges::any_of(here,
                                   [&](const Kind& k) { return isOf(k, all, all[kind.way]); });
    };
    const auto add = [&](std::uint32_t way, std::size_t most, std::uint8_t& count) {
        if (count == most) return;
        window.ways[window.usual + window.others] = way;
        ++count;
    };
    for (const Kind& kind : here) {
        if (kind.count >= usual.fewestWays) add(kind.way, usual.most, window.usual);
    }
    for (std::size_t i = first; i < first + size; ++i) {
        add(std::uint32_t(i), WaysNearby::kMostOthers, window.others);
    }
    for (const Kind& kind : around) {
        if (!isHere(kind)) add(kind.way, WaysNearby::kMostOthers, window.others);
    }
    return window;
}

/// The axis that the side lies nearest to, then a Morton code of the place. Places with near codes are mostly near in
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

std::size_t ChainSeeds::firstNear(std::span<const std::uint32_t> codes, const Vec3& place,
                                  const Vec3& side) const {
    const auto at =
        std::size_t(std::ranges::lower_bound(codes, codeOf(place, side)) - codes.begin());
    return std::min(at - std::min(at, kNear / 2), codes.size() - std::min(kNear, codes.size()));
}

WaysNearby ChainSeeds::near(const Sorted& ways, const Vec3& place, const Vec3& side) const {
    if (ways.seeds.empty()) return {};
    const Window& window = ways.windows[firstNear(ways.codes, place, side)];
    const std::span<const std::uint32_t> known = window.ways;
    const bool inside = length(place - window.centre) <= 1.5f * window.radius;
    return {ways.seeds, known.first(window.usual), known.subspan(window.usual, window.others),
            inside ? window.strength : 0.0};
}

WaysNearby ChainSeeds::near(std::uint32_t light, const Vec3& place, const Vec3& side) const {
    return byLight_.empty() ? WaysNearby{} : near(byLight_[light], place, side);
}

std::span<const ChainSeeds::LightShare> ChainSeeds::lightsNear(const Vec3& place,
                                                               const Vec3& side) const {
    if (shares_.empty()) return {};
    return std::span(shares_).subspan(firstNear(codes_, place, side),
                                      std::min(kNear, shares_.size()));
}

WaysNearby ChainSeeds::nearOfLamps(const Vec3& place, const Vec3& side) const {
    return near(ofLamps_, place, side);
}

}  // namespace lacuna

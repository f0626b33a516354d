// (theory.md, "Lamps that are seen")
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libcore/scene/lamp_node.h"
#include "libcore/scene/ray.h"

namespace lacuna {

namespace {

constexpr double kPiD = std::numbers::pi;
constexpr int kBuckets = 12;  // [Pharr23 12.6.3]
/// Boxes are enlarged by this, relative to the scene's size, because of rounding.
constexpr float kRounding = 0x1p-21f;
/// Largest angle of a bundle's lights to its axis, in radians: the size of a sun, which is either wholly above or
/// wholly below nearly every surface.
constexpr double kBundle = 0.2;
/// Largest rounding error of the directions of a bundle, in radians.
constexpr double kRoundingOfAngles = 1e-5;

Vec3 centreOf(const PlacedLight& l) {
    return (l.low + l.high) * 0.5f;
}

/// `v` rotated about the unit axis `k`.
Vec3d turned(const Vec3d& v, const Vec3d& k, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return v * c + cross(k, v) * s + k * (dot(k, v) * (1.0 - c));
}

}  // namespace

void ShiningCone::add(const ShiningCone& other) {
    fades |= other.fades;
    // The axis of a two-sided lamp may point either way.
    const Vec3d towards =
        twoSided && other.twoSided && dot(axis, other.axis) < 0.0 ? -other.axis : other.axis;
    twoSided |= other.twoSided;
    const Vec3d normal = cross(axis, towards);
    const double between = std::atan2(length(normal), dot(axis, towards));
    if (std::min(between + other.angle, kPiD) <= angle) return;
    if (std::min(between + angle, kPiD) <= other.angle) {
        axis = towards;
        angle = other.angle;
        return;
    }
    const double joined = 0.5 * (angle + between + other.angle);
    if (joined >= kPiD || !(length(normal) > 0.0)) {
        angle = kPiD;
        return;
    }
    axis = normalize(turned(axis, normalize(normal), joined - angle));
    angle = joined;
}

double ShiningCone::measure() const {
    const double o = angle, w = fades ? std::min(angle + 0.5 * kPiD, kPiD) : angle;
    return 2.0 * kPiD * (1.0 - std::cos(o)) + 0.5 * kPiD *
                                                  (2.0 * w * std::sin(o) - std::cos(o - 2.0 * w) -
                                                   2.0 * o * std::sin(o) + std::cos(o));
}

/// Reorders the lights so that those of one half come first. Returns the index at which the other
/// half begins.
std::uint32_t LampTree::Extent::split(std::span<PlacedLight> own) {
    Vec3 low = centreOf(own[0]), high = low;
    for (const PlacedLight& l : own) {
        low = min(low, centreOf(l));
        high = max(high, centreOf(l));
    }
    const Vec3 size = high - low;
    const float longest = std::max({size.x, size.y, size.z});
    const auto bucketOf = [&](const PlacedLight& l, std::size_t axis) {
        const float at = (centreOf(l)[axis] - low[axis]) / size[axis];
        return std::min(int(at * float(kBuckets)), kBuckets - 1);
    };
    double best = std::numeric_limits<double>::infinity();
    std::size_t bestAxis = 3;
    int bestBucket = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(size[axis] > longest * 1e-6f)) continue;
        std::array<Extent, kBuckets> buckets;
        for (const PlacedLight& l : own) buckets[std::size_t(bucketOf(l, axis))].add(l);
        std::array<double, kBuckets> ofRight;
        Extent right, left;
        for (std::size_t b = kBuckets; b-- > 1;) {
            right.add(buckets[b]);
            ofRight[b] = right.cost();
        }
        for (std::size_t b = 0; b + 1 < kBuckets; ++b) {
            left.add(buckets[b]);
            // Thin slabs are penalised: distance separates their lights least.
            const double cost = (left.cost() + ofRight[b + 1]) * double(longest / size[axis]);
            if (cost < best) {
                best = cost;
                bestAxis = axis;
                bestBucket = int(b);
            }
        }
    }
    if (bestAxis == 3) return std::uint32_t(own.size() / 2);  // all at one place
    // The first and the last bucket are not empty.
    const auto right = std::stable_partition(own.begin(), own.end(), [&](const PlacedLight& l) {
        return bucketOf(l, bestAxis) <= bestBucket;
    });
    return std::uint32_t(right - own.begin());
}

LampTree::LampTree(std::vector<PlacedLight> placed, std::span<const DistantLight> distant,
                   float sceneRadius, std::size_t lights, SkySides sky)
    : placeOf_(lights, kNone), sky_(std::move(sky)) {
    toUnits_ = std::ldexp(1.0f, -std::ilogb(sceneRadius));
    double total = 0.0;
    for (const PlacedLight& l : placed) total += l.intensity;
    if (placed.empty()) {
        for (const DistantLight& l : distant) total += l.irradiance;
    }
    constexpr double kLeast = std::numeric_limits<float>::min();
    for (PlacedLight& l : placed) {
        l.low = l.low * toUnits_;
        l.high = l.high * toUnits_;
        l.intensity = std::max(kLeast, l.intensity / total);
    }
    const double units = double(toUnits_);
    ShiningCone cone;
    for (const DistantLight& l : distant) {
        const double relative = l.irradiance / (total * units) / units;
        constexpr double kMost = 1e30;
        placeOf_[l.light] = std::uint32_t(placed.size() + distant_.size());
        add(l, std::clamp(relative, kLeast, kMost), cone);
    }
    for (Distant& d : distant_) {
        d.before /= bundles_[d.bundle].irradiance;
        d.share /= bundles_[d.bundle].irradiance;
    }
    if (!placed.empty()) build(placed);
}

/// Adds a light to the last bundle, whose directions fill `cone`, or to a new bundle.
void LampTree::add(const DistantLight& light, double irradiance, ShiningCone& cone) {
    const ShiningCone own{Vec3d(light.direction)};
    ShiningCone joined = cone;
    joined.add(own);
    const bool isSky = light.direction == Vec3{};
    const bool fits =
        !isSky && !bundles_.empty() && !(bundles_.back().axis == Vec3{}) && joined.angle <= kBundle;
    cone = fits ? joined : own;
    if (!fits) bundles_.push_back({.begin = std::uint32_t(distant_.size())});
    Bundle& bundle = bundles_.back();
    const double angle = cone.angle > 0.0 ? cone.angle + kRoundingOfAngles : 0.0;
    bundle.axis = Vec3(cone.axis);
    bundle.cosine = float(std::cos(angle));
    bundle.sine = float(std::sin(angle));
    distant_.push_back(
        {light.light, std::uint32_t(bundles_.size() - 1), bundle.irradiance, irradiance});
    bundle.irradiance += irradiance;
    bundle.end = std::uint32_t(distant_.size());
}

/// Consecutive leaves.
struct LampTree::Range {
    std::uint32_t begin, end;
    Extent extent;

    Range(std::span<const PlacedLight> lights, std::uint32_t b, std::uint32_t e)
        : begin(b), end(e) {
        for (const PlacedLight& l : lights.subspan(b, e - b)) extent.add(l);
    }
    bool single() const { return end - begin == 1; }
};

void LampTree::build(std::vector<PlacedLight>& lights) {
    struct Open {
        std::size_t node;
        std::uint32_t begin, end;
    };
    std::vector<Open> open{{0, 0, std::uint32_t(lights.size())}};
    nodes_.resize(1);
    while (!open.empty()) {
        const Open next = open.back();
        open.pop_back();
        std::vector<Range> children{Range(lights, next.begin, next.end)};
        while (children.size() < Node::kWidth) {
            // The child with several lights and the largest cost.
            auto worst = children.end();
            for (auto c = children.begin(); c != children.end(); ++c) {
                if (c->single()) continue;
                if (worst == children.end() || c->extent.cost() > worst->extent.cost()) worst = c;
            }
            if (worst == children.end()) break;
            const std::uint32_t begin = worst->begin, end = worst->end;
            const std::uint32_t middle =
                begin + Extent::split(std::span(lights).subspan(begin, end - begin));
            *worst = Range(lights, begin, middle);
            children.insert(worst + 1, Range(lights, middle, end));
        }
        for (std::size_t i = 0; i < children.size(); ++i) {
            const Range& c = children[i];
            nodes_[next.node].set(i, c.extent, c.begin);
            if (c.single()) continue;
            nodes_[next.node].child[i] = std::uint32_t(nodes_.size());
            open.push_back({nodes_.size(), c.begin, c.end});
            nodes_.emplace_back();
        }
    }
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const PlacedLight& l = lights[i];
        leaves_.push_back({l.light, l.share});
        placeOf_[l.light] = i;
        if (l.share < 1.0) placeOf_[l.light + 1] = i;
    }
}

void LampTree::Node::set(std::size_t i, const Extent& e, std::uint32_t first) {
    const Vec3 centre = (e.low + e.high) * 0.5f;
    const float most =
        std::max({1.0f, std::fabs(centre.x), std::fabs(centre.y), std::fabs(centre.z)});
    const Vec3 extent = (e.high - e.low) * 0.5f + Vec3(1.0f, 1.0f, 1.0f) * (most * kRounding);
    x[i] = centre.x, y[i] = centre.y, z[i] = centre.z;
    extentX[i] = extent.x, extentY[i] = extent.y, extentZ[i] = extent.z;
    radius[i] = length(extent);
    const Vec3 axis(e.cone.axis);
    axisX[i] = axis.x, axisY[i] = axis.y, axisZ[i] = axis.z;
    sine[i] = float(std::sin(e.cone.angle));
    cosine[i] = float(std::cos(e.cone.angle));
    fades[i] = e.cone.fades ? 1.0f : 0.0f;
    twoSided[i] = e.cone.twoSided ? 1.0f : 0.0f;
    intensity[i] = float(e.intensity);
    begin[i] = first;
}

}  // namespace lacuna

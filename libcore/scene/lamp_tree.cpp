#include "libcore/scene/lamp_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lacuna {

namespace {

constexpr std::uint32_t kNowhere = 0xffffffffu;
constexpr double kPiD = std::numbers::pi;
constexpr int kBuckets = 12;  // [Pharr23 12.6.3]
/// Boxes are so much larger than they are, in units of the scene's size: rounding.
constexpr float kRounding = 0x1p-21f;
/// What is not behind a surface counts as so far in front of it at least: rounding again.
constexpr float kLeastCosine = 1e-4f;

double below1(double u) {
    return std::min(u, 0x1.fffffffffffffp-1);
}

/// Angles by their sine and cosine, 0 to pi.
struct Angle {
    float sine, cosine;

    /// This less the other one, but not below zero.
    Angle less(const Angle& other) const {
        if (cosine >= other.cosine) return {0.0f, 1.0f};
        return {sine * other.cosine - cosine * other.sine,
                cosine * other.cosine + sine * other.sine};
    }
};
Angle angleOfCosine(float cosine) {
    return {std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), cosine};
}

Vec3 centreOf(const PlacedLight& l) {
    return (l.low + l.high) * 0.5f;
}

/// `v` turned about the unit axis `k`.
Vec3d turned(const Vec3d& v, const Vec3d& k, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return v * c + cross(k, v) * s + k * (dot(k, v) * (1.0 - c));
}

}  // namespace

void ShiningCone::add(const ShiningCone& other) {
    fades |= other.fades;
    // A lamp that shines both ways has its axis either way.
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

/// What a node has of its lights.
struct LampTree::Extent {
    Vec3 low, high;
    ShiningCone cone;
    double intensity = 0.0;  // 0: of none yet

    void add(const Vec3& l, const Vec3& h, const ShiningCone& c, double i) {
        if (intensity == 0.0) {
            *this = {l, h, c, i};
            return;
        }
        low = min(low, l);
        high = max(high, h);
        cone.add(c);
        intensity += i;
    }
    void add(const PlacedLight& l) { add(l.low, l.high, l.cone, l.intensity); }
    void add(const Extent& e) {
        if (e.intensity > 0.0) add(e.low, e.high, e.cone, e.intensity);
    }
    /// What a split is to make small [Conty18 eq 2], with the diagonal in place of the surface,
    /// which lights in a row have none of.
    double cost() const {
        return intensity == 0.0 ? 0.0
                                : intensity * cone.measure() * double(lengthSquared(high - low));
    }
};

LampTree::LampTree(std::vector<PlacedLight> placed, std::span<const DistantLight> distant,
                   float sceneRadius, std::size_t lights)
    : placeOf_(lights, kNowhere) {
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
    for (const DistantLight& l : distant) {
        const double relative = l.irradiance / (total * units) / units;
        constexpr double kMost = 1e30;
        placeOf_[l.light] = std::uint32_t(placed.size() + distant_.size());
        distant_.push_back({l.light, l.direction, float(std::clamp(relative, kLeast, kMost))});
    }
    if (!placed.empty()) build(placed);
}

void LampTree::build(std::vector<PlacedLight>& lights) {
    nodes_.reserve(2 * lights.size());
    nodes_.resize(1);
    std::vector<Range> open{{0, 0, std::uint32_t(lights.size())}};
    while (!open.empty()) {
        const Range range = open.back();
        open.pop_back();
        Extent all;
        for (std::uint32_t i = range.begin; i < range.end; ++i) all.add(lights[i]);
        Node& n = nodes_[range.node];
        n.centre = (all.low + all.high) * 0.5f;
        const float most =
            std::max({1.0f, std::fabs(n.centre.x), std::fabs(n.centre.y), std::fabs(n.centre.z)});
        n.extent = (all.high - all.low) * 0.5f + Vec3(1.0f, 1.0f, 1.0f) * (most * kRounding);
        n.radius2 = lengthSquared(n.extent);
        n.axis = Vec3(all.cone.axis);
        n.sine = float(std::sin(all.cone.angle));
        n.cosine = float(std::cos(all.cone.angle));
        n.fades = all.cone.fades;
        n.twoSided = all.cone.twoSided;
        n.intensity = float(all.intensity);
        n.middle = range.begin;
        if (range.end - range.begin == 1) continue;
        const std::uint32_t middle = split(lights, range);
        n.middle = middle;
        n.child = std::uint32_t(nodes_.size());
        open.push_back({n.child + 1, middle, range.end});
        open.push_back({n.child, range.begin, middle});
        nodes_.resize(nodes_.size() + 2);
    }
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const PlacedLight& l = lights[i];
        leaves_.push_back({l.light, l.share});
        placeOf_[l.light] = i;
        if (l.share < 1.0) placeOf_[l.light + 1] = i;
    }
}

/// Sorts the range's lights so that those of the left child come first; returns where the right
/// one's begin.
std::uint32_t LampTree::split(std::vector<PlacedLight>& lights, const Range& range) {
    const auto own = std::span(lights).subspan(range.begin, range.end - range.begin);
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
            // Thin slabs are what distance tells least about.
            const double cost = (left.cost() + ofRight[b + 1]) * double(longest / size[axis]);
            if (cost < best) {
                best = cost;
                bestAxis = axis;
                bestBucket = int(b);
            }
        }
    }
    if (bestAxis == 3) return (range.begin + range.end) / 2;  // all in one place
    // The first and the last bucket have a light each.
    const auto right = std::stable_partition(own.begin(), own.end(), [&](const PlacedLight& l) {
        return bucketOf(l, bestAxis) <= bestBucket;
    });
    return range.begin + std::uint32_t(right - own.begin());
}

/// From above: intensity over squared distance with the cosines at both ends, wherever in the box
/// and in the cone the light may be. Distances are no less than the box's own size, so that nodes
/// around the point stay comparable.
double LampTree::importance(const Node& n, const Viewpoint& from) const {
    const Vec3 to = n.centre - from.position;
    const Vec3 side = from.side;
    const bool oneSide = side != Vec3{};
    const float across = dot(side, to);
    if (oneSide) {
        const float up = across + std::fabs(side.x) * n.extent.x + std::fabs(side.y) * n.extent.y +
                         std::fabs(side.z) * n.extent.z;
        if (up <= 0.0f) return 0.0;
    }
    const float d2 = lengthSquared(to);
    if (d2 <= n.radius2) return double(n.intensity) / double(n.radius2);
    const float inverse = 1.0f / std::sqrt(d2);
    const float boxSine = std::sqrt(n.radius2) * inverse;
    const Angle box{boxSine, std::sqrt(1.0f - boxSine * boxSine)};
    float arriving = 1.0f;
    if (oneSide) {
        const float cosine = std::clamp(across * inverse, -1.0f, 1.0f);
        arriving = std::max(kLeastCosine, angleOfCosine(cosine).less(box).cosine);
    }
    const float along = std::clamp(-dot(n.axis, to) * inverse, -1.0f, 1.0f);
    const Angle off =
        angleOfCosine(n.twoSided ? std::fabs(along) : along).less({n.sine, n.cosine}).less(box);
    const float leaving = n.fades ? off.cosine : off.cosine < 1.0f ? 0.0f : 1.0f;
    if (!(leaving > 0.0f)) return 0.0;
    return double(n.intensity) * double(arriving * leaving) / double(d2);
}

double LampTree::importance(const Distant& light, const Viewpoint& from) const {
    if (from.side == Vec3{} || light.direction == Vec3{}) return double(light.irradiance);
    const float cosine = dot(from.side, light.direction);
    return cosine > 0.0f ? double(light.irradiance) * double(cosine) : 0.0;
}

/// Where neither child can send anything, it does not matter which is picked, and all shares still
/// sum to one.
double LampTree::shareOfLeft(const Node& node, const Viewpoint& from) const {
    const Node &a = nodes_[node.child], &b = nodes_[node.child + 1];
    const double left = importance(a, from), right = importance(b, from);
    const double sum = left + right;
    return sum > 0.0 ? left / sum : double(a.intensity) / double(a.intensity + b.intensity);
}

LampTree::Roots LampTree::roots(const Viewpoint& from) const {
    if (distant_.empty()) return {1.0, 1.0, false};
    const double tree = nodes_.empty() ? 0.0 : importance(nodes_[0], from);
    double sum = tree;
    for (const Distant& d : distant_) sum += importance(d, from);
    if (sum > 0.0) return {tree, sum, false};
    const double ofTree = nodes_.empty() ? 0.0 : 1.0;
    return {ofTree, ofTree + double(distant_.size()), true};
}

double LampTree::share(const Roots& roots, const Distant& light, const Viewpoint& from) const {
    return (roots.even ? 1.0 : importance(light, from)) / roots.sum;
}

LampTree::Pick LampTree::pick(const Viewpoint& fileFrom, double u) const {
    const Viewpoint from = scaled(fileFrom);
    const Roots top = roots(from);
    double pmf = top.tree / top.sum;
    if (u >= pmf && !distant_.empty()) {
        u -= pmf;
        // The last one that can be picked at all has what rounding leaves over.
        Pick found{};
        for (const Distant& d : distant_) {
            const double p = share(top, d, from);
            if (!(p > 0.0)) continue;
            found = {d.light, p, below1(u / p)};
            if (u < p) break;
            u -= p;
        }
        return found;
    }
    u = below1(u / pmf);
    const Node* node = &nodes_[0];
    while (node->child != 0) {
        const double left = shareOfLeft(*node, from);
        const bool isLeft = u < left;
        const double p = isLeft ? left : 1.0 - left;
        u = below1((isLeft ? u : u - left) / p);
        pmf *= p;
        node = &nodes_[node->child + (isLeft ? 0 : 1)];
    }
    const Leaf& leaf = leaves_[node->middle];
    const bool isFirst = u < leaf.share;
    const std::uint32_t light = leaf.light + (isFirst ? 0 : 1);
    const double p = leaf.shareOf(light);
    return {light, pmf * p, below1((isFirst ? u : u - leaf.share) / p)};
}

double LampTree::pmf(const Viewpoint& fileFrom, std::uint32_t light) const {
    const std::uint32_t place = placeOf_[light];
    if (place == kNowhere) return 0.0;
    const Viewpoint from = scaled(fileFrom);
    const Roots top = roots(from);
    if (place >= leaves_.size()) return share(top, distant_[place - leaves_.size()], from);
    double pmf = top.tree / top.sum;
    const Node* node = &nodes_[0];
    while (node->child != 0 && pmf > 0.0) {
        const double left = shareOfLeft(*node, from);
        const bool isLeft = place < node->middle;
        pmf *= isLeft ? left : 1.0 - left;
        node = &nodes_[node->child + (isLeft ? 0 : 1)];
    }
    return pmf * leaves_[place].shareOf(light);
}

double LampTree::importance(const Viewpoint& fileFrom, std::uint32_t light) const {
    const std::uint32_t place = placeOf_[light];
    if (place == kNowhere) return 0.0;
    const Viewpoint from = scaled(fileFrom);
    if (place >= leaves_.size()) return importance(distant_[place - leaves_.size()], from);
    const Node* node = &nodes_[0];
    while (node->child != 0) {
        node = &nodes_[node->child + (place < node->middle ? 0 : 1)];
    }
    return importance(*node, from);
}

std::uint64_t LampTree::bytes() const {
    return nodes_.size() * sizeof(Node) + leaves_.size() * sizeof(Leaf) +
           placeOf_.size() * sizeof(std::uint32_t);
}

}  // namespace lacuna

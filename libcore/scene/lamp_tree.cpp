// (theory.md, "Lamps that are seen")
#include "libcore/scene/lamp_tree.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/below1.h"
#include "libcore/scene/lamp_node.h"
#include "libcore/scene/ray.h"

namespace lacuna {

namespace {

/// Least cosine at the receiver for lights that are not entirely behind its surface, because of
/// rounding.
constexpr float kLeastCosine = 1e-4f;

/// Least emission of a surface in relation to the bound: the typical value is no bound.
constexpr float kLeastUsual = 0.1f;

}  // namespace

/// Importance: intensity over squared distance, times the cosines at both ends. These are upper bounds over the box and
/// the cone; the emission of surfaces is about the mean instead. It is zero only if no light can arrive. Distances are
/// at least half the box's diagonal, so that nodes around the point stay comparable. There are no branches, so that all
/// children are weighed at once.
void LampTree::Node::weigh(const Viewpoint& from, Lanes& importance) const {
    const Vec3 p = from.position, side = from.side;
    const Vec3 size{std::fabs(side.x), std::fabs(side.y), std::fabs(side.z)};
    // Without a side, everything is above it and every cosine is one.
    const float up = side == Vec3{} ? 2.0f : 0.0f;
    for (std::size_t i = 0; i < kWidth; ++i) {
        const float tx = x[i] - p.x, ty = y[i] - p.y, tz = z[i] - p.z;
        const float d2 = tx * tx + ty * ty + tz * tz, r2 = radius[i] * radius[i];
        const float inverse = 1.0f / std::sqrt(std::max(d2, r2));
        // The half angle of the box's bounding sphere, seen from the point; a right angle inside
        // it.
        const float boxSine = radius[i] * inverse;
        const float boxCosine = std::sqrt(std::max(0.0f, 1.0f - boxSine * boxSine));

        const float across = side.x * tx + side.y * ty + side.z * tz;
        const float highest =
            across + size.x * extentX[i] + size.y * extentY[i] + size.z * extentZ[i];
        const float c = std::min(1.0f, std::max(-1.0f, across * inverse)) + up;
        const float s = std::sqrt(std::max(0.0f, 1.0f - c * c));
        const float nearest = std::max(kLeastCosine, c * boxCosine + s * boxSine);
        const float above = highest + up > 0.0f ? 1.0f : 0.0f;
        const float arriving = c >= boxCosine ? above : above * nearest;

        const float toAxis = -(axisX[i] * tx + axisY[i] * ty + axisZ[i] * tz) * inverse;
        const float either = twoSided[i] > 0.0f ? std::fabs(toAxis) : toAxis;
        const float a = std::min(1.0f, std::max(-1.0f, either));
        const float b = std::sqrt(std::max(0.0f, 1.0f - a * a));
        const bool inCone = a >= cosine[i];
        const float offCosine = inCone ? 1.0f : a * cosine[i] + b * sine[i];
        const float offSine = inCone ? 0.0f : b * cosine[i] - a * sine[i];
        const bool mayBeIn = offCosine >= boxCosine;
        const float faded = std::max(0.0f, offCosine * boxCosine + offSine * boxSine) * fades[i];
        const float most = mayBeIn ? 1.0f : faded;
        // For surfaces whose normals fill the cone: the mean of the cosine, and from it about the
        // mean of its positive part.
        const float mean = 0.5f * a * (1.0f + cosine[i]);
        const float scatter = cosine[i] > 0.0f ? 0.5f * sine[i] : 0.5f;
        const float usual = 0.5f * (mean + std::sqrt(mean * mean + scatter * scatter));
        const float leaving =
            fades[i] > 0.0f ? std::max(kLeastUsual * most, std::min(usual, most)) : most;

        const float cosines = d2 <= r2 ? above : arriving * leaving;
        importance[i] = intensity[i] * cosines / std::max(d2, r2);
    }
}

/// The weights of the children. If no child can send light, any choice will do, but the shares must
/// still sum to one.
LampTree::Shares LampTree::Node::shares(const Viewpoint& from) const {
    Shares result;
    weigh(from, result.weights);
    for (const float w : result.weights) result.sum += double(w);
    if (result.sum > 0.0) return result;
    result.dark = true;
    result.weights = intensity;
    for (const float w : result.weights) result.sum += double(w);
    return result;
}

/// Irradiance times the cosine of the bundle's direction that is closest to the side, which is
/// positive unless all are behind it. For a sky, the irradiance of that side.
double LampTree::importanceOf(const Bundle& bundle, const Viewpoint& from) const {
    if (from.side == Vec3{}) return bundle.irradiance;
    if (bundle.axis == Vec3{}) return bundle.irradiance * double(sky_.at(from.side));
    const float c = dot(from.side, bundle.axis);
    if (c >= bundle.cosine) return bundle.irradiance;
    const float s = std::sqrt(std::max(0.0f, 1.0f - c * c));
    return bundle.irradiance * double(std::max(0.0f, c * bundle.cosine + s * bundle.sine));
}

LampTree::Roots LampTree::roots(const Viewpoint& from) const {
    Roots roots;
    if (!nodes_.empty()) roots.node = nodes_[0].shares(from);
    if (distant_.empty()) return roots;
    roots.tree = roots.node.dark ? 0.0 : roots.node.sum;
    roots.sum = roots.tree;
    for (const Bundle& b : bundles_) roots.sum += importanceOf(b, from);
    if (roots.sum > 0.0) return roots;
    roots.even = true;
    roots.tree = nodes_.empty() ? 0.0 : 1.0;
    roots.sum = roots.tree + double(bundles_.size());
    return roots;
}

double LampTree::shareOf(const Roots& roots, const Bundle& bundle, const Viewpoint& from) const {
    return (roots.even ? 1.0 : importanceOf(bundle, from)) / roots.sum;
}

/// `pmf`: probability of the leaf.
LampTree::Pick LampTree::pickIn(const Leaf& leaf, double pmf, double u) {
    const bool isFirst = u < leaf.share;
    const std::uint32_t light = leaf.light + (isFirst ? 0 : 1);
    const double ofLeaf = leaf.shareOf(light);
    return {light, pmf * ofLeaf, below1((isFirst ? u : u - leaf.share) / ofLeaf)};
}

/// `pmf`: probability of the bundle.
LampTree::Pick LampTree::pickIn(const Bundle& bundle, double pmf, double u) const {
    const auto begin = distant_.begin() + bundle.begin, end = distant_.begin() + bundle.end;
    const auto behind = std::upper_bound(begin + 1, end, u,
                                         [](double x, const Distant& d) { return x < d.before; });
    const Distant& found = *(behind - 1);
    return {found.light, pmf * found.share, below1((u - found.before) / found.share)};
}

LampTree::Pick LampTree::pick(const Viewpoint& fileFrom, double u) const {
    if (isOneLeaf()) return pickIn(leaves_[0], 1.0, u);
    const Viewpoint from = scaled(fileFrom);
    const Roots top = roots(from);
    double pmf = top.tree / top.sum;
    if (u >= pmf && !distant_.empty()) {
        u -= pmf;
        // The last bundle with positive probability takes the remainder due to rounding.
        Pick found{};
        for (const Bundle& b : bundles_) {
            const double p = shareOf(top, b, from);
            if (!(p > 0.0)) continue;
            found = pickIn(b, p, below1(u / p));
            if (u < p) break;
            u -= p;
        }
        return found;
    }
    u = below1(u / pmf);
    Shares shares = top.node;
    for (const Node* node = &nodes_[0];;) {
        std::size_t chosen = 0;
        double rest = u * shares.sum;
        for (std::size_t i = 0; i < Node::kWidth; ++i) {
            const double weight = double(shares.weights[i]);
            if (!(weight > 0.0)) continue;
            chosen = i;
            if (rest < weight) break;
            rest -= weight;
        }
        pmf *= shares[chosen];
        u = below1(rest / double(shares.weights[chosen]));
        if (node->child[chosen] != 0) {
            node = &nodes_[node->child[chosen]];
            shares = node->shares(from);
            continue;
        }
        return pickIn(leaves_[node->begin[chosen]], pmf, u);
    }
}

double LampTree::pmf(const Viewpoint& fileFrom, std::uint32_t light) const {
    const std::uint32_t place = placeOf_[light];
    if (place == kNone) return 0.0;
    if (isOneLeaf()) return leaves_[0].shareOf(light);
    const Viewpoint from = scaled(fileFrom);
    const Roots top = roots(from);
    if (place >= leaves_.size()) {
        const Distant& d = distant_[place - leaves_.size()];
        return shareOf(top, bundles_[d.bundle], from) * d.share;
    }
    double pmf = top.tree / top.sum;
    Shares shares = top.node;
    for (const Node* node = &nodes_[0];;) {
        const std::size_t child = node->childOf(place);
        pmf *= shares[child];
        if (node->child[child] == 0 || !(pmf > 0.0)) break;
        node = &nodes_[node->child[child]];
        shares = node->shares(from);
    }
    return pmf * leaves_[place].shareOf(light);
}

double LampTree::importance(const Viewpoint& fileFrom, std::uint32_t light) const {
    const std::uint32_t place = placeOf_[light];
    if (place == kNone) return 0.0;
    const Viewpoint from = scaled(fileFrom);
    if (place >= leaves_.size()) {
        const Distant& d = distant_[place - leaves_.size()];
        return importanceOf(bundles_[d.bundle], from) * d.share;
    }
    const Node* node = &nodes_[0];
    std::size_t child = node->childOf(place);
    while (node->child[child] != 0) {
        node = &nodes_[node->child[child]];
        child = node->childOf(place);
    }
    Node::Lanes weights;
    node->weigh(from, weights);
    return double(weights[child]);
}

std::uint64_t LampTree::bytes() const {
    return nodes_.size() * sizeof(Node) + leaves_.size() * sizeof(Leaf) +
           placeOf_.size() * sizeof(std::uint32_t) + distant_.size() * sizeof(Distant) +
           bundles_.size() * sizeof(Bundle);
}

LampTree::LampTree() = default;
LampTree::LampTree(LampTree&&) noexcept = default;
LampTree& LampTree::operator=(LampTree&&) noexcept = default;
LampTree::~LampTree() = default;

}  // namespace lacuna

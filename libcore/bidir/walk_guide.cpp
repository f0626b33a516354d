#include "libcore/bidir/walk_guide.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "libcore/base/content_hash.h"

namespace lacuna {

namespace {
constexpr double kBelowOne = 0x1.fffffep-1;
}

SquarePoint DirectionSquare::pointOf(const Vec3& direction) const {
    const Vec3 d = frame_.toLocal(direction);
    double first = std::min(double(d.x) * double(d.x) + double(d.y) * double(d.y), kBelowOne);
    if (bothSides_) first = 0.5 * first + (d.z < 0.0f ? 0.5 : 0.0);
    const double turns = double(turnsOf(d.y, d.x));
    return {first, std::min(turns < 0.0 ? turns + 1.0 : turns, kBelowOne)};
}

Vec3 DirectionSquare::directionAt(SquarePoint point) const {
    const bool below = bothSides_ && point[0] >= 0.5;
    const double sine2 = bothSides_ ? 2.0 * point[0] - (below ? 1.0 : 0.0) : point[0];
    const SineCosine angle = sineCosineOfTurns(float(point[1]));
    const auto sine = float(std::sqrt(sine2));
    const auto cosine = float(std::sqrt(std::max(0.0, 1.0 - sine2)));
    return renormalize(
        frame_.toWorld({sine * angle.cosine, sine * angle.sine, below ? -cosine : cosine}));
}

WalkGuide::Place WalkGuide::placeOf(const PathVertex& v) {
    const Vec3 side = scatteringSide(v);
    const bool passes = lengthSquared(side) == 0.0f;
    const Vec3 n = passes ? v.ng : side;
    return {(passes ? kPasses : 0u) | (v.bsdf.isNarrow() ? kNarrow : 0u),
            {v.position.x, v.position.y, v.position.z, n.x, n.y, n.z}};
}

WalkGuide::WalkGuide(std::vector<Node> nodes, std::vector<Region> regions)
    : nodes_(std::move(nodes)), regions_(std::move(regions)) {
    const auto require = [](bool good, const char* what) {
        if (!good) throw std::invalid_argument(std::string("guide of walks: ") + what);
    };
    require(nodes_.size() >= kKinds && nodes_.size() <= kChildMask, "no nodes, or too many");
    // Children stand behind their node and are those of one node alone, so nothing goes in circles.
    std::vector<bool> reached(nodes_.size());
    std::fill_n(reached.begin(), kKinds, true);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& n = nodes_[i];
        require(reached[i], "nodes that hang together");
        if (!(n.code & kInner)) {
            require(n.code < regions_.size(), "regions");
            continue;
        }
        const std::size_t child = n.code & kChildMask;
        require(((n.code >> kNumberShift) & 7u) < 6, "six numbers of a place");
        require(std::isfinite(n.threshold), "thresholds");
        require(child > i && child >= kKinds && child + 1 < nodes_.size(),
                "children behind their node");
        for (const std::size_t c : {child, child + 1}) {
            require(!reached[c], "children of one node");
            reached[c] = true;
        }
    }
    for (const Region& r : regions_) {
        require(std::abs(length(r.square.axis()) - 1.0f) < 1e-4f, "unit axes");
        for (const Field& f : r.fields) {
            require(f.share >= 0.0f && f.share <= kMostShare, "shares");
        }
    }
}

WalkGuide WalkGuide::of(Side side) const {
    WalkGuide one = *this;
    for (Region& r : one.regions_) {
        r.fields[std::size_t(side == Side::Eye ? Side::Light : Side::Eye)] = Field{};
    }
    return one;
}

void WalkGuide::mix(std::uint32_t number, const Vec3& toEye, const Vec3& toLight,
                    ScatterEvent event, BsdfEvaluation& e) const {
    const Region& r = regions_[number];
    const auto mixed = [&](Side side, const Vec3& to, float& pdfW) {
        const float share = r.of(side).share;
        if (share == 0.0f) return;
        pdfW *= 1.0f - share;
        if (!isDelta(event)) pdfW += share * r.pdfW(side, to);
    };
    mixed(Side::Eye, toLight, e.pdfWToLight);
    mixed(Side::Light, toEye, e.pdfWToEye);
}

std::string WalkGuide::contentHash() const {
    ContentHash hash;
    hash.addValue(std::uint64_t(nodes_.size()));
    hash.addValues(std::span(nodes_));
    for (const Region& r : regions_) {
        hash.addValue(r.square.axis());
        hash.addValue(std::uint32_t(r.square.bothSides()));
        for (const Field& f : r.fields) {
            hash.addValue(f.share);
            hash.addValue(std::uint64_t(f.directions.nodes().size()));
            hash.addValues(f.directions.nodes());
        }
    }
    return hash.hex();
}

}  // namespace lacuna

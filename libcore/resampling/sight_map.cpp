#include "libcore/resampling/sight_map.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

namespace {

/// Direction of a point of [-1, 1]^2: the octahedron |x| + |y| + |z| = 1, its lower half folded
/// outwards [Praun03].
Vec3 octahedronDirection(Vec2 p) {
    Vec3 d{p.x, p.y, 1.0f - std::abs(p.x) - std::abs(p.y)};
    if (d.z < 0.0f) {
        const float x = d.x;
        d.x = std::copysign(1.0f - std::abs(d.y), x);
        d.y = std::copysign(1.0f - std::abs(x), d.y);
    }
    return normalize(d);
}

Vec2 octahedronPoint(const Vec3& d) {
    const float sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
    const float x = d.x / sum, y = d.y / sum;
    if (d.z >= 0.0f) return {x, y};
    return {std::copysign(1.0f - std::abs(y), x), std::copysign(1.0f - std::abs(x), y)};
}

}  // namespace

SightMap::SightMap(const Vec3& origin, const PathSpace& space, RayTally& tally)
    : origin_(origin), farthest_(kCells * kCells) {
    std::vector<float> distance(kSize * kSize);
    for (std::size_t i = 0; i < distance.size(); ++i) {
        // Cells' corners, the outermost on the square's border: neighbours span all directions.
        const Vec2 p{2.0f * float(i % kSize) / float(kCells) - 1.0f,
                     2.0f * float(i / kSize) / float(kCells) - 1.0f};
        distance[i] = space.reach(origin, octahedronDirection(p), tally);
    }
    for (std::size_t i = 0; i < farthest_.size(); ++i) {
        const float* corner = &distance[i / kCells * kSize + i % kCells];
        const float most = std::max({corner[0], corner[1], corner[kSize], corner[kSize + 1]});
        farthest_[i] = 1.01f * most * (1.01f * most);
    }
}

bool SightMap::sees(const PathVertex& y) const {
    const Vec3 to = y.infinite() ? y.position : y.position - origin_;
    const float d2 = lengthSquared(to);
    if (!(d2 > 0.0f)) return true;
    const Vec2 p = octahedronPoint(to);
    const auto cell = [](float x) {
        const float c = (x + 1.0f) * 0.5f * float(kCells);
        return std::min(std::size_t(std::max(c, 0.0f)), kCells - 1);
    };
    const float farthest = farthest_[cell(p.y) * kCells + cell(p.x)];
    return y.infinite() ? std::isinf(farthest) : d2 <= farthest;
}

}  // namespace lacuna

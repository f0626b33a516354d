// (theory.md, "Nodes")
#include "libcore/resampling/sight_map.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/octahedron.h"

namespace lacuna {

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

#include "tests/skeleton/voxel_shapes.h"

#include <algorithm>

#include "libcore/base/rng.h"

namespace lacuna::test {

double distanceToSolid(const VoxelSpace& space, const Vec3d& p) {
    double best = 1e6;
    for (std::size_t i = 0; i < space.state.size(); ++i) {
        if (space.state[i] != VoxelState::Solid) continue;
        const Vec3d low = space.shape.corner(space.shape.indexOf(i));
        const Vec3d away = max(max(low - p, p - low - Vec3d{1, 1, 1}), Vec3d{});
        best = std::min(best, length(away));
    }
    return best;
}

VoxelSpace drawn(const VoxelIndex& size, const IsSolid& solid, const Vec3d& origin) {
    VoxelSpace space;
    space.shape = {size, origin, 1.0};
    space.state.resize(space.shape.count());
    space.distance.resize(space.shape.count(), 0.0f);
    for (std::size_t i = 0; i < space.state.size(); ++i) {
        const VoxelIndex v = space.shape.indexOf(i);
        space.state[i] = solid(v[0], v[1], v[2]) ? VoxelState::Solid : VoxelState::Empty;
    }
    for (std::size_t i = 0; i < space.state.size(); ++i) {
        if (space.state[i] != VoxelState::Empty) continue;
        space.distance[i] =
            float(distanceToSolid(space, space.shape.centre(space.shape.indexOf(i))));
    }
    return space;
}

VoxelSpace randomSpace(const VoxelIndex& size, double solid, std::uint64_t seed) {
    Rng rng(seed, 0, StreamKind::User, 0);
    return drawn(size, [&](int, int, int) { return rng.uniformDouble() < solid; });
}

}  // namespace lacuna::test

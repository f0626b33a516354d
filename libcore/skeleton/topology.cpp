#include "libcore/skeleton/topology.h"

#include "libcore/voxel/components.h"

namespace lacuna {

Betti emptySpaceBetti(const VoxelSpace& space) {
    const Components empty(space.shape, space.state,
                           {.solid = false, .unreachedIsSolid = true, .outside = false},
                           Connectivity::Corners);
    const Components solid(space.shape, space.state,
                           {.solid = true, .unreachedIsSolid = true, .outside = true},
                           Connectivity::Faces);
    Betti b;
    b.b0 = std::int64_t(empty.count());
    b.b2 = std::int64_t(solid.count()) - 1;  // one component of the solid is the outside
    b.b1 = b.b0 + b.b2 - CubicalComplex(space).euler();
    return b;
}

}  // namespace lacuna

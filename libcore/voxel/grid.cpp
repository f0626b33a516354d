#include "libcore/voxel/grid.h"

#include "libcore/base/content_hash.h"

namespace lacuna {

std::string VoxelSpace::contentHash() const {
    ContentHash hash;
    hash.addValue(shape.size);
    hash.addValue(std::array{shape.origin.x, shape.origin.y, shape.origin.z, shape.voxel});
    hash.addValues(std::span(state));
    hash.addValues(std::span(distance));
    return hash.hex();
}

}  // namespace lacuna

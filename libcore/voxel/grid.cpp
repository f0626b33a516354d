#include "libcore/voxel/grid.h"

#include <xxhash.h>

#include <cstdio>

namespace lacuna {

std::string VoxelSpace::contentHash() const {
    const double place[4] = {shape.origin.x, shape.origin.y, shape.origin.z, shape.voxel};
    XXH3_state_t* hash = XXH3_createState();
    XXH3_128bits_reset(hash);
    XXH3_128bits_update(hash, shape.size.data(), sizeof(shape.size));
    XXH3_128bits_update(hash, place, sizeof(place));
    XXH3_128bits_update(hash, state.data(), state.size() * sizeof(VoxelState));
    XXH3_128bits_update(hash, distance.data(), distance.size() * sizeof(float));
    const XXH128_hash_t digest = XXH3_128bits_digest(hash);
    XXH3_freeState(hash);
    char text[33];
    std::snprintf(text, sizeof(text), "%016llx%016llx", (unsigned long long)(digest.high64),
                  (unsigned long long)(digest.low64));
    return text;
}

}  // namespace lacuna

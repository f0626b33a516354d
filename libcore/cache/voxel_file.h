// KEY.voxels.vdb, which lacuna-voxelize writes. It holds two grids in the scene file's coordinates
// that any OpenVDB viewer shows: "solid" (topology) and "distance" (active where empty and
// reached). (files.md, "Voxels")
#pragma once

#include "libcore/cache/cache_name.h"
#include "libcore/voxel/grid.h"

namespace lacuna {

struct VoxelFile {
    VoxelSpace space;
    CacheStamp stamp;
};

/// Writes the file. `centre`: Scene::centre(). Throws RunError.
void writeVoxelFile(const std::string& path, const VoxelFile& file, const Vec3d& centre);

/// Throws InputError if the file is missing, damaged, of another kind or version, or made of other
/// inputs than `expected` names; `remedy` tells the user what to do.
VoxelFile readVoxelFile(const std::string& path, const CacheStamp& expected, const Vec3d& centre,
                        const std::string& remedy);

}  // namespace lacuna

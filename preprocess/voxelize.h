// What lacuna-voxelize does, for it and for lacuna-render --prepare.
#pragma once

#include <string>

#include "libcore/cache/voxel_file.h"
#include "libcore/voxel/reach.h"
#include "libcore/voxel/voxel_settings.h"
#include "preprocess/phases.h"

namespace lacuna {

/// "x0,y0,z0,x1,y1,z1" with x0 < x1, .. Throws UsageError.
VoxelBox parseDomain(const std::string& text);

struct Voxelized {
    VoxelFile file;
    PartCounts parts;
};

/// What voxels and the skeleton of them are made of.
CacheStamp voxelStamp(const Settings& sceneInputs, const VoxelSettings& settings);

/// `stamp` says what the voxels are made of. Throws UsageError for a domain that holds nothing of
/// the scene, InputError for a scene without geometry, Error 130 once `cancel` is set.
Voxelized voxelizeScene(const Scene& scene, const VoxelSettings& settings, const CacheStamp& stamp,
                        const ThreadPool& pool, const std::atomic<bool>& cancel, Phases& phases);

}  // namespace lacuna

// The work of lacuna-voxelize, also for lacuna-render --prepare.
#pragma once

#include <string>

#include "libcore/cache/voxel_file.h"
#include "libcore/voxel/reach.h"
#include "libcore/voxel/voxel_settings.h"
#include "preprocess/phases.h"

namespace lacuna {

/// Parses "x0,y0,z0,x1,y1,z1" with x0 < x1, .. Throws UsageError.
VoxelBox parseDomain(const std::string& text);

struct Voxelized {
    VoxelFile file;
    PartCounts parts;
};

/// The inputs of voxels and of their skeleton.
CacheStamp voxelStamp(const Settings& sceneInputs, const VoxelSettings& settings);

/// Voxelizes the scene. `stamp`: the inputs of the voxels. Throws UsageError for a domain without
/// any part of the scene, InputError for a scene without geometry, InterruptedError once `cancel`
/// is set.
Voxelized voxelizeScene(const Scene& scene, const VoxelSettings& settings, const CacheStamp& stamp,
                        const ThreadPool& pool, const std::atomic<bool>& cancel, Phases& phases);

}  // namespace lacuna

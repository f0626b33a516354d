// Settings of the voxelization: one table that the tools, lacuna-render's methods and the caches'
// keys share.
#pragma once

#include <string>

#include "libcore/base/options.h"

namespace lacuna {

struct VoxelSettings {
    static constexpr int kLowestResolution = 8, kHighestResolution = 1024;

    int resolution = 128;
    std::string
        domain;  ///< "x0,y0,z0,x1,y1,z1" in the file's coordinates; empty: the default domain
};

inline OptionTable<VoxelSettings> voxelOptions() {
    return OptionTable<VoxelSettings>()
        .integer("resolution", &VoxelSettings::resolution, VoxelSettings::kLowestResolution,
                 VoxelSettings::kHighestResolution, "voxels", "along the longest side")
        .text("domain", &VoxelSettings::domain,
              "box to voxelize, x0,y0,z0,x1,y1,z1 in the scene's coordinates")
        .standardText("what the camera reaches");
}

}  // namespace lacuna

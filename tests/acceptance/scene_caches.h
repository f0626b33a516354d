// Coarse versions, made in memory, of the caches that the preprocessing tools write, so that rows
// that need caches can be tested.
#pragma once

#include "libcore/methods/registry.h"
#include "libcore/scene/scene.h"

namespace lacuna::test {

/// Gives `method` the assets that `row` needs: a skeleton of the empty space at 24 voxels,
/// subspaces trained on 4000 paths. A scene without surfaces or without an empty voxel has no
/// skeleton. Then nothing is given, because methods must work without it.
void giveCaches(Method& method, const MethodRow& row, const Scene& scene, const ThreadPool& pool);

}  // namespace lacuna::test

// The caches that the preprocess tools would have written for a scene, coarse and made on the spot,
// so that rows which need some are tested with them.
#pragma once

#include "libcore/methods/registry.h"
#include "libcore/scene/scene.h"

namespace lacuna::test {

/// Gives `method` what `row` needs: a skeleton of the empty space at 24 voxels, subspaces trained
/// on 4000 paths. A scene without surfaces or without a voxel of empty space has no skeleton:
/// nothing is given then, as methods must work without.
void giveCaches(Method& method, const MethodRow& row, const Scene& scene, const ThreadPool& pool);

}  // namespace lacuna::test

#pragma once

#include "preprocess/assets.h"

namespace lacuna {

/// The curve skeleton of the empty space and the map of its nodes (skeletonize.h):
/// AssetRow::acquire. If it must be made, its voxels are read, or made and written as well.
std::unique_ptr<Asset> acquireSkeleton(const AssetRequest& request);

}  // namespace lacuna

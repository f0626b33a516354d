#pragma once

#include "preprocess/assets.h"

namespace lacuna {

/// Subspaces, Q and Gamma (train.h): AssetRow::acquire. They are trained with the default seed,
/// whatever the picture's, so that there is only one result.
std::unique_ptr<Asset> acquireSubspaces(const AssetRequest& request);

}  // namespace lacuna

#pragma once

#include "preprocess/assets.h"

namespace lacuna {

/// Subspaces, Q and Gamma (train.h): AssetRow::acquire. They are trained with the default seed,
/// whatever the picture's: there is one result for all.
std::unique_ptr<Asset> acquireSubspaces(const AssetRequest& request);

}  // namespace lacuna

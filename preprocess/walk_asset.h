// Guided walks as an asset.
#pragma once

#include "libcore/cache/walk_file.h"
#include "preprocess/assets.h"
#include "preprocess/learn_walks.h"

namespace lacuna {

/// Gives methods the guide as std::shared_ptr<const WalkGuide>, or nothing if sampling BSDFs is as
/// good: AssetRow::acquire.
std::unique_ptr<Asset> acquireWalks(const AssetRequest& request);

/// The content of the file.
WalkFile walkFile(const CacheStamp& stamp, const WalkTraining& training);
/// Replaces the hash if there is no guide.
inline constexpr const char* kPlainWalks = "plain";

}  // namespace lacuna

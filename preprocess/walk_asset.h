// Guided walks, as methods need them.
#pragma once

#include "libcore/cache/walk_file.h"
#include "preprocess/assets.h"
#include "preprocess/learn_walks.h"

namespace lacuna {

/// Gives methods the guide, as std::shared_ptr<const WalkGuide>; nothing where BSDFs are as good.
std::unique_ptr<Asset> acquireWalks(const AssetRequest& request);

/// What is written of it.
WalkFile walkFile(const CacheStamp& stamp, const WalkTraining& training);
/// In place of a guide's hash where there is none.
inline constexpr const char* kPlainWalks = "plain";

}  // namespace lacuna

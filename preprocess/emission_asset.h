// Learned emission, as methods need it.
#pragma once

#include "libcore/cache/emission_file.h"
#include "preprocess/assets.h"
#include "preprocess/learn_emission.h"

namespace lacuna {

/// Gives methods the guide, as std::shared_ptr<const EmissionGuide>; nothing where plain emission is
/// as good.
std::unique_ptr<Asset> acquireEmission(const AssetRequest& request);

/// What is written of it.
EmissionFile emissionFile(const CacheStamp& stamp, const EmissionTraining& training);
/// In place of a guide's hash where there is none.
inline constexpr const char* kPlainEmission = "plain";

/// What the guides among `assets` make of the scene's light and walks.
Guides guidesOf(const Scene& scene, const AssetSet& assets);

}  // namespace lacuna

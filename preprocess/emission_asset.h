// Learned emission as an asset.
#pragma once

#include "libcore/cache/emission_file.h"
#include "preprocess/assets.h"
#include "preprocess/learn_emission.h"

namespace lacuna {

/// Gives methods the guide as std::shared_ptr<const EmissionGuide>, or nothing if plain emission is
/// as good: AssetRow::acquire.
std::unique_ptr<Asset> acquireEmission(const AssetRequest& request);

/// The content of the file.
EmissionFile emissionFile(const CacheStamp& stamp, const EmissionTraining& training);
/// Replaces the hash if there is no guide.
inline constexpr const char* kPlainEmission = "plain";

/// The guided lights and the guide of walks that follow from `assets`.
Guides guidesOf(const Scene& scene, const AssetSet& assets);

}  // namespace lacuna

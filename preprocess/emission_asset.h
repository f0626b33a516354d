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

/// The lights as the guide among `assets` has them; null where there is none.
std::shared_ptr<const Lights> guidedLights(const Scene& scene, const AssetSet& assets);

}  // namespace lacuna

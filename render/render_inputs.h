// Everything that the pixels of a render depend on, except the number of iterations. All parts of
// one picture have the same inputs.
#pragma once

#include "libcore/cache/cache_name.h"
#include "render/caches.h"
#include "render/options.h"
#include "render/stage.h"

namespace lacuna {

CacheStamp renderInputs(const RenderOptions& options, const MethodRow& row,
                        const Settings& settings, const Stage& stage, const Caches& caches,
                        const BlockPlan& plan);

}  // namespace lacuna

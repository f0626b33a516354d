// Whatever the pixels of a render depend on but the number of its iterations: parts of one picture
// agree in it.
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

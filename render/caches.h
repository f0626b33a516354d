// The assets that a method needs, read from the scene's cache or (with --prepare) made.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "preprocess/assets.h"
#include "render/options.h"

namespace lacuna {

struct Caches {
    std::vector<std::unique_ptr<Asset>> assets;  ///< in the order in which they are made
    std::map<std::string, std::string> hashes;   ///< of their content, by name
    std::map<std::string, double> phaseSeconds;
    double seconds = 0.0;

    AssetSet all() const;
};

/// Reads the assets that `row` needs. A missing or stale cache causes an InputError that names the
/// command to make it; with options.prepare it is made and written instead. Throws InterruptedError
/// if `cancel` is set meanwhile.
Caches loadCaches(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                  const SceneStage& stage, const ThreadPool& pool, const std::atomic<bool>& cancel,
                  Progress& progress);

}  // namespace lacuna

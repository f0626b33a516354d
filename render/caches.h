// The caches that a method needs, read or (with --prepare) built.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <string>

#include "libcore/methods/registry.h"
#include "libcore/scene/scene.h"
#include "libcore/skeleton/node_map.h"
#include "libcore/subspace/subspaces.h"
#include "render/options.h"
#include "render/progress.h"

namespace lacuna {

struct Caches {
    std::shared_ptr<const Skeleton> skeleton;    ///< null where the method needs none
    std::shared_ptr<const Subspaces> subspaces;  ///< likewise
    std::map<std::string, std::string> hashes;   ///< of their content, by kind
    std::map<std::string, double> phaseSeconds;
    double seconds = 0.0;

    void giveTo(Method& method) const;
};

/// Reads what `row` needs from the scene's cache. A missing or stale cache is an InputError that
/// names the command that builds it; with options.prepare it is built and written instead. Throws
/// Error 130 if `cancel` is set meanwhile.
Caches loadCaches(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                  const Scene& scene, const ThreadPool& pool, const std::atomic<bool>& cancel,
                  Progress& progress);

}  // namespace lacuna

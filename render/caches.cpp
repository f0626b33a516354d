#include "render/caches.h"

namespace lacuna {

AssetSet Caches::all() const {
    AssetSet set;
    for (const auto& asset : assets) asset->giveTo(set);
    return set;
}

Caches loadCaches(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                  const SceneStage& stage, const ThreadPool& pool, const std::atomic<bool>& cancel,
                  Progress& progress) {
    Caches caches;
    const std::vector<AssetNeed> needs = needsOf(row, settings);
    if (needs.empty()) {
        if (options.prepare) {
            progress.remark("--prepare: " + row.name + " needs no caches: nothing to build");
        }
        return caches;
    }
    Phases phases(
        [&](const std::string& name) { progress.phase("preparing: " + name, kNothingWritten); });
    Phases total;
    const auto built = [&](const std::string& path) {
        if (options.common.verbose) progress.remark("built " + path);
    };
    total.run("all", [&] {
        AssetSet before;
        for (const AssetNeed& need : needs) {
            caches.assets.push_back(findAsset(need.name).acquire(
                {stage, options, settings, row.techniques, need.prefix, before, options.prepare,
                 pool, cancel, phases, built}));
            caches.assets.back()->giveTo(before);
            caches.hashes[need.name] = caches.assets.back()->contentHash();
        }
    });
    caches.phaseSeconds = phases.seconds();
    caches.seconds = total.seconds().at("all");
    return caches;
}

}  // namespace lacuna

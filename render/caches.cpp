#include "render/caches.h"

namespace lacuna {

void Caches::giveTo(Method& method) const {
    AssetSet set;
    for (const auto& asset : assets) asset->giveTo(set);
    method.use(set);
}

Caches loadCaches(const RenderOptions& options, const MethodRow& row, const Settings& settings,
                  const SceneStage& stage, const ThreadPool& pool, const std::atomic<bool>& cancel,
                  Progress& progress) {
    Caches caches;
    if (row.needs.empty()) {
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
        for (const AssetNeed& need : row.needs) {
            caches.assets.push_back(
                findAsset(need.name).acquire({stage, options, settings, need.prefix,
                                              options.prepare, pool, cancel, phases, built}));
            caches.hashes[need.name] = caches.assets.back()->contentHash();
        }
    });
    caches.phaseSeconds = phases.seconds();
    caches.seconds = total.seconds().at("all");
    return caches;
}

}  // namespace lacuna

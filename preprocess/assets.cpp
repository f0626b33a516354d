#include "preprocess/assets.h"

#include <algorithm>
#include <stdexcept>

#include "preprocess/emission_asset.h"
#include "preprocess/skeleton_asset.h"
#include "preprocess/subspace_asset.h"
#include "preprocess/walk_asset.h"

namespace lacuna {

std::string AssetRequest::directory() const {
    return cacheDirectory(options.scene, options.common.cacheDirectory);
}

std::string AssetRequest::file(const CacheStamp& stamp, const std::string& kind) const {
    return cacheFile(directory(), stamp, kind);
}

std::span<const AssetRow> assetRows() {
    static const AssetRow rows[] = {
        {"emission", acquireEmission},
        {"skeleton", acquireSkeleton},
        {"subspaces", acquireSubspaces},
        {"walks", acquireWalks},
    };
    return rows;
}

const AssetRow& findAsset(const std::string& name) {
    const auto rows = assetRows();
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const AssetRow& r) { return r.name == name; });
    if (row == rows.end()) throw std::logic_error("no asset is called " + name);
    return *row;
}

}  // namespace lacuna

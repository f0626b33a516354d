// Assets: data about a scene that methods need beforehand, such as a skeleton or subspaces. Each
// asset can be read, made, hashed and drawn. To add one, write a file in this folder and a row in
// assets.cpp.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "libcore/bidir/asset_set.h"
#include "libcore/bidir/film.h"
#include "libcore/bidir/method.h"
#include "libcore/cache/cache_name.h"
#include "libcore/image/image.h"
#include "libcore/tool/scene_stage.h"
#include "preprocess/phases.h"

namespace lacuna {

/// An asset in memory.
class Asset {
  public:
    virtual ~Asset() = default;
    virtual void giveTo(AssetSet& assets) const = 0;
    /// Hash of its content: assets with the same hash are the same to a method.
    virtual std::string contentHash() const = 0;
    /// Adds layers to the picture that visualise the asset at the visible point of each pixel of
    /// `crop`.
    virtual void draw(LayeredImage& image, const Scene& scene, const Camera& camera,
                      const PixelRect& crop, const ThreadPool& pool) const = 0;
};

/// The request for an asset.
struct AssetRequest {
    const SceneStage& stage;
    const SceneOptions& options;   ///< of the stage, for the cache and for messages
    const Settings& settings;      ///< of the method
    const Techniques& techniques;  ///< of the method's row
    const std::string& prefix;     ///< before the asset's own options in `settings`: "voxels."
    const AssetSet& before;        ///< the method's assets that exist already
    bool build;                    ///< whether to make it if there is no usable file
    const ThreadPool& pool;
    const std::atomic<bool>& cancel;
    Phases& phases;
    std::function<void(const std::string& path)> built;  ///< called for each file written

    std::string directory() const;
    /// The path of the file of that stamp and kind ("subspaces"), whether it exists or not.
    std::string file(const CacheStamp& stamp, const std::string& kind) const;
};

struct AssetRow {
    std::string name;  ///< the name in AssetNeed
    /// Reads the asset from the scene's cache, or makes it. If it is missing and must not be made,
    /// throws InputError, which tells the inputs that differ and the command that makes it. Also
    /// throws InterruptedError once `cancel` is set, and RunError.
    std::unique_ptr<Asset> (*acquire)(const AssetRequest& request);
};

std::span<const AssetRow> assetRows();
/// The row of that name. Throws std::logic_error if there is none.
const AssetRow& findAsset(const std::string& name);

/// For implementations of rows: reads a cache. `readFile` (path, stamp, remedy) returns the file of
/// that stamp or throws InputError. If the file cannot be used, the result is empty if the asset
/// may be made. Otherwise readCache rethrows the error of `readFile`, with the inputs in which the
/// most similar file of this kind differs.
template <class File, class ReadFile>
std::optional<File> readCache(const AssetRequest& request, const CacheStamp& stamp,
                              const std::string& kind, const std::string& remedy,
                              const ReadFile& readFile);

/// For assets of one file: the result of readCache, in a phase of its own, or else that of `make`
/// (), which `write` (path, file) writes.
template <class File, class ReadFile, class WriteFile, class Make>
File readOrMake(const AssetRequest& request, const CacheStamp& stamp, const std::string& kind,
                const std::string& remedy, const ReadFile& readFile, const WriteFile& write,
                const Make& make);

}  // namespace lacuna

#include "preprocess/assets_inl.h"

// Assets: what methods need to be made of a scene beforehand, a skeleton or subspaces. Each knows
// how it is read, made, hashed and drawn. Adding one = a file in this folder and a row in
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
    /// Of its content: two files with the same one are the same to a method.
    virtual std::string contentHash() const = 0;
    /// Layers of the picture that show what belongs to what is seen in each pixel of `crop`.
    virtual void draw(LayeredImage& image, const Scene& scene, const Camera& camera,
                      const PixelRect& crop, const ThreadPool& pool) const = 0;
};

/// What an asset is read or made for.
struct AssetRequest {
    const SceneStage& stage;
    const SceneOptions& options;   ///< as the stage was loaded with, for the cache and for messages
    const Settings& settings;      ///< of the method
    const Techniques& techniques;  ///< of the method, as its row has them
    const std::string& prefix;     ///< of the asset's own options among them: "voxels."
    const AssetSet& before;        ///< what the method needs and is there already
    bool build;                    ///< where there is no file of it, or none that can be used
    const ThreadPool& pool;
    const std::atomic<bool>& cancel;
    Phases& phases;
    std::function<void(const std::string& path)> built;  ///< called with each file that is written

    std::string directory() const;
    /// The path of the file of that stamp and kind ("subspaces"), whether it is there or not.
    std::string file(const CacheStamp& stamp, const std::string& kind) const;
};

struct AssetRow {
    std::string name;  ///< as AssetNeed has it
    /// Reads it from the scene's cache, or makes it. Throws InputError that says which inputs
    /// differ and which command makes it, where it is not there and not asked to be made; Error 130
    /// once `cancel` is set; RunError.
    std::unique_ptr<Asset> (*acquire)(const AssetRequest& request);
};

std::span<const AssetRow> assetRows();
/// Throws std::logic_error for a name that no row has.
const AssetRow& findAsset(const std::string& name);

/// For the rows: `readFile` (path, stamp, remedy) gives the file of that stamp, or throws
/// InputError. Empty where it cannot be used and is asked to be made; else throws what `readFile`
/// threw, with the inputs in which the most similar file of this kind differs.
template <class File, class ReadFile>
std::optional<File> readCache(const AssetRequest& request, const CacheStamp& stamp,
                              const std::string& kind, const std::string& remedy,
                              const ReadFile& readFile);

/// For rows whose asset is one file: readCache, in a phase of its own, or else what `make` () gives,
/// written by `write` (path, file).
template <class File, class ReadFile, class WriteFile, class Make>
File readOrMake(const AssetRequest& request, const CacheStamp& stamp, const std::string& kind,
                const std::string& remedy, const ReadFile& readFile, const WriteFile& write,
                const Make& make);

}  // namespace lacuna

#include "preprocess/assets_inl.h"

// Where a scene's caches lie: NAME.cache/KEY.KIND beside the scene, or in --cache DIR. (files.md,
// "Names and keys")
#pragma once

#include <cstdint>
#include <string>

#include "libcore/subspace/training_settings.h"

namespace lacuna {

/// What a cache belongs to. `settings` is the text of everything else that its content depends on.
struct CacheStamp {
    std::string sceneHash;
    std::string settings;
    friend bool operator==(const CacheStamp&, const CacheStamp&) = default;
};

/// The stamp of voxels and skeleton. `domain` is the text of --domain, or empty.
CacheStamp voxelStamp(const std::string& sceneHash, int resolution, const std::string& domain);

CacheStamp subspaceStamp(const std::string& sceneHash, const TrainingSettings& settings);
/// The settings as lacuna-train takes them: "--paths 1000000 --subspaces 1000 ..".
std::string trainOptions(const TrainingSettings& settings);

/// `directory`, or NAME.cache beside the scene where that is empty.
std::string cacheDirectory(const std::string& scene, const std::string& directory);

/// DIRECTORY/KEY.kind, KEY = 16 hex digits of the stamp's hash: caches of different settings lie
/// side by side.
std::string cacheFile(const std::string& directory, const CacheStamp& stamp,
                      const std::string& kind);

/// Makes the directory that `file` is to lie in. Throws RunError that asks for --cache DIR.
void makeCacheDirectory(const std::string& file);

}  // namespace lacuna

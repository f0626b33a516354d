// Where a scene's caches lie: NAME.cache/KEY.KIND beside the scene, or in --cache DIR.
#pragma once

#include <cstdint>
#include <string>

namespace lacuna {

/// What a cache belongs to. `settings` is the text of everything else that its content depends on.
struct CacheStamp {
    std::string sceneHash;
    std::string settings;
    friend bool operator==(const CacheStamp&, const CacheStamp&) = default;
};

/// The stamp of voxels and skeleton. `domain` is the text of --domain, or empty.
CacheStamp voxelStamp(const std::string& sceneHash, int resolution, const std::string& domain);

/// What subspaces depend on beside the scene, with lacuna-train's defaults. Not the seed: what is
/// trained with any is good for all renders.
struct SubspaceSettings {
    std::uint64_t paths = 1'000'000;
    std::uint32_t subspaces = 1000;
    std::uint64_t lightPaths = 2'000'000;
    int epochs = 20;
    double directionWeight = 0.05;  ///< k_d [Su22 eq 18]
    double lightShare = 0.2;        ///< of the subspaces, those that divide the lights [Su22 7.2.1]
};

CacheStamp subspaceStamp(const std::string& sceneHash, const SubspaceSettings& settings);
/// The settings as lacuna-train takes them: "--paths 1000000 --subspaces 1000 ..".
std::string trainOptions(const SubspaceSettings& settings);

/// `directory`, or NAME.cache beside the scene where that is empty.
std::string cacheDirectory(const std::string& scene, const std::string& directory);

/// DIRECTORY/KEY.kind, KEY = 16 hex digits of the stamp's hash: caches of different settings lie
/// side by side.
std::string cacheFile(const std::string& directory, const CacheStamp& stamp,
                      const std::string& kind);

/// Makes the directory that `file` is to lie in. Throws RunError that asks for --cache DIR.
void makeCacheDirectory(const std::string& file);

}  // namespace lacuna

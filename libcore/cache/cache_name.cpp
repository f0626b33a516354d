#include "libcore/cache/cache_name.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "libcore/base/error.h"

namespace lacuna {

CacheStamp voxelStamp(const std::string& sceneHash, int resolution, const std::string& domain) {
    return {sceneHash, "resolution=" + std::to_string(resolution) +
                           " domain=" + (domain.empty() ? "auto" : domain)};
}

CacheStamp subspaceStamp(const std::string& sceneHash, const TrainingSettings& settings) {
    CacheStamp stamp{sceneHash, {}};
    for (const auto& [name, value] : trainingOptions().values(settings)) {
        stamp.settings += (stamp.settings.empty() ? "" : " ") + name + "=" + value;
    }
    return stamp;
}

std::string trainOptions(const TrainingSettings& settings) {
    std::string text;
    for (auto [name, value] : trainingOptions().values(settings)) {
        std::replace(name.begin(), name.end(), '_', '-');
        text += (text.empty() ? "--" : " --") + name + " " + value;
    }
    return text;
}

std::string cacheDirectory(const std::string& scene, const std::string& directory) {
    if (!directory.empty()) return directory;
    std::filesystem::path path(scene);
    path.replace_extension(".cache");
    return path.string();
}

std::string cacheFile(const std::string& directory, const CacheStamp& stamp,
                      const std::string& kind) {
    const std::string text = stamp.sceneHash + "\n" + stamp.settings;
    char key[17];
    std::snprintf(key, sizeof(key), "%016llx",
                  (unsigned long long)(XXH3_64bits(text.data(), text.size())));
    return (std::filesystem::path(directory) / (std::string(key) + "." + kind)).string();
}

void makeCacheDirectory(const std::string& file) {
    const std::filesystem::path directory = std::filesystem::path(file).parent_path();
    if (directory.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) {
        throw RunError(directory.string() +
                       ": expected to make this directory for caches, found: " + error.message() +
                       "; name a place with --cache DIR");
    }
}

}  // namespace lacuna

#include "libcore/cache/cache_name.h"

#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <utility>
#include <vector>

#include "libcore/base/error.h"

namespace lacuna {

namespace {
/// The fewest digits that tell the number from all others.
std::string shortest(double value) {
    char buffer[32];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

std::vector<std::pair<std::string, std::string>> namesAndValues(const SubspaceSettings& s) {
    return {{"paths", std::to_string(s.paths)},
            {"subspaces", std::to_string(s.subspaces)},
            {"light_paths", std::to_string(s.lightPaths)},
            {"epochs", std::to_string(s.epochs)},
            {"direction_weight", shortest(s.directionWeight)},
            {"light_share", shortest(s.lightShare)}};
}
}  // namespace

CacheStamp voxelStamp(const std::string& sceneHash, int resolution, const std::string& domain) {
    return {sceneHash, "resolution=" + std::to_string(resolution) +
                           " domain=" + (domain.empty() ? "auto" : domain)};
}

CacheStamp subspaceStamp(const std::string& sceneHash, const SubspaceSettings& settings) {
    CacheStamp stamp{sceneHash, {}};
    for (const auto& [name, value] : namesAndValues(settings)) {
        stamp.settings += (stamp.settings.empty() ? "" : " ") + name + "=" + value;
    }
    return stamp;
}

std::string trainOptions(const SubspaceSettings& settings) {
    std::string text;
    for (auto [name, value] : namesAndValues(settings)) {
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

// What the preprocessing tools share: the scene, the place of their result, what they report.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "libcore/scene/scene.h"
#include "preprocess/voxelize.h"
#include "render/tool.h"

namespace lacuna {

/// The options of one tool that builds a cache of a scene.
struct BuildOptions {
    CommonOptions common;
    std::string scene, output;
};

/// SCENE, -o and the common options. Both must outlive the parsing.
void addBuildOptions(CLI::App& app, BuildOptions& options);
/// Throws UsageError if the JSON and the result are one file; RunError where the JSON cannot be
/// written.
void checkFiles(const BuildOptions& options);

/// Loads in the pool's threads. Throws InputError.
std::unique_ptr<Scene> loadScene(const std::string& file, const ThreadPool& pool);

/// Where the result goes: -o, or the cache's own name (whose directory is made). Throws RunError if
/// it cannot be written.
std::string resultFile(const BuildOptions& options, const CacheStamp& stamp,
                       const std::string& kind);

/// Largest memory the process has had.
std::uint64_t peakBytes();

/// Atomically, where --json asks for it. Throws RunError.
void writeReport(const CommonOptions& options, const nlohmann::json& report);

}  // namespace lacuna

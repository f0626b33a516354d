// What the preprocessing tools share: options, the place of their result, what they report.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "libcore/cache/cache_name.h"
#include "libcore/tool/scene_options.h"

namespace lacuna {

/// The options of one tool that builds a cache of a scene.
struct BuildOptions : SceneOptions {
    std::string output;
};

/// SCENE, -o, the common options and those of the scene. Both must outlive the parsing.
void addBuildOptions(CLI::App& app, BuildOptions& options);
/// Checks what the scene has no say in. Throws UsageError for a value out of its range, and if the
/// JSON and the result are one file; RunError where the JSON cannot be written.
void checkBuildOptions(BuildOptions& options);

/// Where the result goes: -o, or the cache's own name (whose directory is made). Throws RunError if
/// it cannot be written.
std::string resultFile(const BuildOptions& options, const CacheStamp& stamp,
                       const std::string& kind);

/// Largest memory the process has had.
std::uint64_t peakBytes();

/// Atomically, where --json asks for it. Throws RunError.
void writeReport(const CommonOptions& options, const nlohmann::json& report);

}  // namespace lacuna

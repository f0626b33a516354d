// Shared parts of the preprocessing tools: options, path of the result, report.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "libcore/cache/cache_name.h"
#include "libcore/tool/scene_options.h"

namespace lacuna {

/// The options of one tool that builds a cache of a scene.
struct BuildOptions : SceneOptions {
    std::string output;
};

/// Declares SCENE, -o, the common options and those of the scene. Both arguments must outlive the
/// parsing.
void addBuildOptions(CLI::App& app, BuildOptions& options);
/// Checks everything that does not depend on the scene. Throws UsageError for a value out of its
/// range, and if the JSON and the result are one file; RunError if the JSON cannot be written.
void checkBuildOptions(BuildOptions& options);

/// The path of the result: -o, or the cache's own name (whose directory is created). Throws
/// RunError if it cannot be written.
std::string resultFile(const BuildOptions& options, const CacheStamp& stamp,
                       const std::string& kind);

/// Peak memory of the process.
std::uint64_t peakBytes();

/// Writes the report atomically if --json asks for it. Throws RunError.
void writeReport(const CommonOptions& options, const nlohmann::json& report);

}  // namespace lacuna

// What the pictures are compared with: an image that is there, or one that the study renders and
// continues; and how far it is from converged itself.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "libcore/image/error_metrics.h"
#include "render/progress.h"
#include "render/study/plan.h"

namespace lacuna {

struct Reference {
    std::string path;
    std::string hash;  ///< of the file
    /// What another rendering as converged as this one would be off by on average, from the
    /// variance in the file; none where it holds no variance.
    std::optional<ErrorMeasures> ownError;
    std::string origin;  ///< one line for people
};

/// Renders the parts that are missing below `directory` and averages all, weighted by their
/// iterations. Parts have seeds from a million on, which no run of a study has. Returns the image's
/// path. Throws Error with the renderer's exit code; Error 130 if interrupted.
std::string renderReference(const StudyScene& scene, const SceneFacts& facts, int threads,
                            const std::string& directory, const std::string& renderer,
                            const std::atomic<bool>& cancel, Progress& progress);

/// Reads and checks: size, finite values; where the header says so also scene and depth. Throws
/// InputError that names the file.
Reference openReference(const std::string& path, const SceneFacts& facts);

}  // namespace lacuna

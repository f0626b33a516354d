// What the pictures are compared with: an image that is there, or one that the study renders and
// continues; and how far it is from converged itself.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "libcore/image/error_metrics.h"
#include "libcore/tool/progress.h"
#include "render/study/plan.h"

namespace lacuna {

/// Inside one of the scene's crops.
struct CropReference {
    ErrorReference picture;
    std::optional<ErrorMeasures> ownError;  ///< as that of the whole reference
};

struct Reference {
    std::string path;
    std::string hash;  ///< of the file
    /// What another rendering as converged as this one would be off by on average, from the
    /// variance in the file; none where it holds no variance.
    std::optional<ErrorMeasures> ownError;
    std::string origin;                ///< one line for people
    std::vector<CropReference> crops;  ///< by crop of the scene
};

/// The pixels of `rect`, which lies within the image.
Image cropped(const Image& image, const PixelRect& rect);
/// What the image, of the whole picture or of the crop that is rendered, has of the latter.
Image renderedPart(const Image& image, const SceneFacts& facts);

/// Renders the parts that are missing below `directory` and averages all, weighted by their
/// iterations. Parts have seeds from a million on, which no run of a study has. Returns the image's
/// path. Throws Error with the renderer's exit code; Error 130 if interrupted.
std::string renderReference(const StudyScene& scene, const SceneFacts& facts, int threads,
                            const std::string& directory, const std::string& renderer,
                            const std::atomic<bool>& cancel, Progress& progress);

/// Reads and checks: size, finite values; where the header says so also scene and depth. `crops`
/// lie within what is rendered. Throws InputError that names the file.
Reference openReference(const std::string& path, const SceneFacts& facts,
                        const std::vector<StudyCrop>& crops);

}  // namespace lacuna

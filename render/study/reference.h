// The reference of the comparisons: an existing image, or one that the study renders and continues;
// and its own remaining error.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "libcore/image/error_metrics.h"
#include "libcore/tool/progress.h"
#include "render/study/plan.h"

namespace lacuna {

/// The reference inside one of the scene's crops.
struct CropReference {
    ErrorReference picture;
    std::optional<ErrorMeasures> ownError;  ///< like Reference::ownError
};

struct Reference {
    std::string path;
    std::string hash;  ///< hash of the file
    /// Expected errors of the reference, from the variance in the file; none if it has no variance.
    std::optional<ErrorMeasures> ownError;
    std::string origin;                ///< a description in one line
    std::vector<CropReference> crops;  ///< by crop of the scene
};

/// The pixels of `rect`, which must lie within the image.
Image cropped(const Image& image, const PixelRect& rect);
/// The rendered crop's part of an image, which shows either the whole picture or that crop.
Image renderedPart(const Image& image, const SceneFacts& facts);

/// Renders the parts that are missing below `directory` and averages all, weighted by their
/// iterations. The seeds of parts start at a million, beyond those of a study's runs. Returns the
/// image's path. Throws Error with the renderer's exit code, InterruptedError if interrupted.
std::string renderReference(const StudyScene& scene, const SceneFacts& facts, int threads,
                            const std::string& directory, const std::string& renderer,
                            const std::atomic<bool>& cancel, Progress& progress);

/// Reads a reference and checks its size and that values are finite; if the header has them, also
/// scene and depth. `crops` must lie within the rendered part. Throws InputError, which names the
/// file.
Reference openReference(const std::string& path, const SceneFacts& facts,
                        const std::vector<StudyCrop>& crops);

}  // namespace lacuna

// Which renders a study consists of, in which order, and what each is known by.
#pragma once

#include <string>
#include <vector>

#include "libcore/base/parallel.h"
#include "render/study/study_file.h"

namespace lacuna {

/// What has to be known of a scene before anything is rendered.
struct SceneFacts {
    std::string hash;           ///< of the scene and its environment
    std::string contentHash;    ///< of the scene alone, as images name it
    int width = 0, height = 0;  ///< of the whole picture
    PixelRect crop;             ///< what is rendered of it
    int maxDepth = 0;
};

/// Loads the scene once. Throws as lacuna-render would, naming the scene's file.
SceneFacts inspectScene(const StudyScene& scene, const ThreadPool& pool);

struct PlannedRun {
    std::size_t scene = 0, method = 0;  ///< indices into the study
    std::uint64_t seed = 0;
    std::vector<std::string> arguments;  ///< all but the scene, results and reference
    std::string id;                      ///< changes whenever the run has to be repeated
};

/// `referenceHashes`: of the references' content, by scene. `renderer`: what names the renderer's
/// version (its content's hash). `machine`: times of different machines do not mix.
///
/// For every scene and seed all methods follow each other, so that a machine that becomes slower
/// or busier meets all alike; each seed begins with another method, so that none is always first.
std::vector<PlannedRun> planRuns(const Study& study, const std::vector<SceneFacts>& facts,
                                 const std::vector<std::string>& referenceHashes,
                                 const std::string& renderer, const std::string& machine);

/// A run with --techniques per scene and method, of the first seed; none where the study asks for
/// none. Their pictures are looked at, not timed: no matter on which machine they were made.
std::vector<PlannedRun> planTechniques(const Study& study, const std::vector<SceneFacts>& facts,
                                       const std::string& renderer);

/// An id from the arguments and everything else that a run depends on.
std::string runId(const std::vector<std::string>& arguments,
                  const std::vector<std::string>& dependencies);

}  // namespace lacuna

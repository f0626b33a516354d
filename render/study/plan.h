// The renders of a study, their order and their ids.
#pragma once

#include <string>
#include <vector>

#include "libcore/base/parallel.h"
#include "render/study/study_file.h"

namespace lacuna {

/// Facts about a scene that are needed before anything is rendered.
struct SceneFacts {
    std::string hash;           ///< of the scene and its environment
    std::string contentHash;    ///< of the scene alone, as in images' headers
    int width = 0, height = 0;  ///< of the whole picture
    PixelRect crop;             ///< the rendered part
    int maxDepth = 0;
};

/// Loads the scene to find its facts. Throws the errors of lacuna-render, which name the scene's
/// file.
SceneFacts inspectScene(const StudyScene& scene, const ThreadPool& pool);

struct PlannedRun {
    std::size_t scene = 0, method = 0;  ///< indices into the study
    std::uint64_t seed = 0;
    std::vector<std::string> arguments;  ///< all except scene, results and reference
    std::string id;                      ///< changes whenever the run must be repeated
};

/// `referenceHashes`: hashes of the references' content, by scene. `renderer`: hash of the
/// renderer, which identifies its version. `machine`: included in ids, because times of different
/// machines must not be mixed.
///
/// For every scene and seed, all methods run one after the other, so that a machine that becomes
/// slower or busier affects all alike. Each seed begins with another method, so that none is always
/// first.
std::vector<PlannedRun> planRuns(const Study& study, const std::vector<SceneFacts>& facts,
                                 const std::vector<std::string>& referenceHashes,
                                 const std::string& renderer, const std::string& machine);

/// One run with --techniques for each scene and method, with the first seed; none if the study does
/// not request it. These runs are not timed, so that the machine does not matter.
std::vector<PlannedRun> planTechniques(const Study& study, const std::vector<SceneFacts>& facts,
                                       const std::string& renderer);

/// The id of a run, from its arguments and everything else on which it depends.
std::string runId(const std::vector<std::string>& arguments,
                  const std::vector<std::string>& dependencies);

}  // namespace lacuna

#include "render/study/execute.h"

#include "libcore/base/error.h"
#include "libcore/methods/registry.h"
#include "render/study/content_hash.h"
#include "render/study/machine.h"
#include "render/study/run_directory.h"

namespace lacuna {
namespace {

/// Scenes and the references that are there first; then the references that take long.
void findReferences(Results& results, const std::string& directory, const std::string& renderer,
                    const std::atomic<bool>& cancel, Progress& progress) {
    const Study& study = results.study;
    results.references.resize(study.scenes.size());
    {
        const ThreadPool pool(study.threads);
        for (std::size_t s = 0; s < study.scenes.size(); ++s) {
            results.facts.push_back(inspectScene(study.scenes[s], pool));
            if (study.scenes[s].recipe) continue;
            results.references[s] = openReference(study.scenes[s].reference, results.facts[s]);
        }
    }
    for (std::size_t s = 0; s < study.scenes.size(); ++s) {
        if (!study.scenes[s].recipe) continue;
        const std::string path =
            renderReference(study.scenes[s], results.facts[s], study.threads,
                            directory + "/references", renderer, cancel, progress);
        results.references[s] = openReference(path, results.facts[s]);
    }
}

void renderRun(const Results& results, const PlannedRun& run, const RunDirectory& directory,
               const std::string& renderer, const std::atomic<bool>& cancel) {
    std::vector<std::string> arguments = run.arguments;
    arguments.insert(arguments.end(), {"--reference", results.references[run.scene].path});
    if (findMethod(results.study.methods[run.method].method).needsCaches()) {
        arguments.insert(arguments.end(), {"--prepare", "--cache", directory.cache()});
    }
    directory.render(renderer, results.study.scenes[run.scene].file, arguments, cancel);
}

}  // namespace

Execution execute(const Study& study, const std::string& directory, const std::string& renderer,
                  const std::atomic<bool>& cancel, Progress& progress) {
    Execution execution;
    Results& results = execution.results;
    results.study = study;
    results.machine = machineText();
    results.rendererHash = fileHash(renderer);
    findReferences(results, directory, renderer, cancel, progress);
    std::vector<std::string> referenceHashes;
    for (const Reference& r : results.references) referenceHashes.push_back(r.hash);

    const std::vector<PlannedRun> plan =
        planRuns(study, results.facts, referenceHashes, results.rendererHash, results.machine);
    for (std::size_t i = 0; i < plan.size(); ++i) {
        const PlannedRun& run = plan[i];
        const RunDirectory folder(directory + "/runs/" + run.id);
        if (!folder.complete()) {
            progress.phase("run " + std::to_string(i + 1) + " of " + std::to_string(plan.size()) +
                           ": " + study.scenes[run.scene].name + ", " +
                           study.methods[run.method].name + ", seed " + std::to_string(run.seed));
            renderRun(results, run, folder, renderer, cancel);
            ++execution.rendered;
        }
        results.runs.push_back({run, readCurve(folder.curve()), folder.report(), folder.image()});
        if (results.runs.back().report.at("scene_hash") != results.facts[run.scene].contentHash) {
            throw InputError(study.scenes[run.scene].file +
                             ": expected it to stay as it is while the study runs, found it "
                             "changed; run the study again");
        }
    }
    return execution;
}

}  // namespace lacuna

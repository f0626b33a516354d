#include "render/study/execute.h"

#include <filesystem>
#include <span>

#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"
#include "libcore/image/image_io.h"
#include "libcore/methods/registry.h"
#include "render/choose/choice.h"
#include "render/code_file.h"
#include "render/study/machine.h"
#include "render/study/run_directory.h"

namespace lacuna {
namespace {

std::string rangeText(const char* axis, int low, int high) {
    return std::string(axis) + " " + std::to_string(low) + " to " + std::to_string(high);
}

/// Checks crops against the size of the picture, which the study's file alone does not tell.
void requireCropsInside(const Study& study, std::size_t s, const SceneFacts& facts) {
    const StudyScene& scene = study.scenes[s];
    const int width = facts.crop.width(), height = facts.crop.height();
    for (const StudyCrop& crop : scene.crops) {
        const PixelRect& r = crop.rect;
        if (r.x1 <= width && r.y1 <= height) continue;
        throw InputError(study.file + ": scenes[" + std::to_string(s) + "]: crop '" + crop.name +
                         "': expected a part of the " + std::to_string(width) + " x " +
                         std::to_string(height) + " pixels that are rendered, found " +
                         rangeText("x", r.x0, r.x1) + ", " + rangeText("y", r.y0, r.y1) +
                         "; move it or change width and height");
    }
}

bool rendersReference(const StudyScene& scene) {
    return scene.recipe && !std::filesystem::exists(scene.reference);
}

/// Copies the reference to the path that the study's file names.
void keepReference(const std::string& from, const std::string& to) {
    std::error_code error;
    std::filesystem::copy_file(from, to, error);
    if (error)
        throw RunError(to + ": expected to keep the reference here, found " + error.message());
}

/// Inspects scenes and existing references first, then renders missing references, which take long.
void findReferences(Results& results, const std::string& directory, const std::string& renderer,
                    const std::atomic<bool>& cancel, Progress& progress) {
    const Study& study = results.study;
    results.references.resize(study.scenes.size());
    {
        const ThreadPool pool(study.threads);
        for (std::size_t s = 0; s < study.scenes.size(); ++s) {
            const StudyScene& scene = study.scenes[s];
            results.facts.push_back(inspectScene(scene, pool));
            requireCropsInside(study, s, results.facts[s]);
            if (rendersReference(scene)) continue;
            results.references[s] = openReference(scene.reference, results.facts[s], scene.crops);
        }
    }
    for (std::size_t s = 0; s < study.scenes.size(); ++s) {
        const StudyScene& scene = study.scenes[s];
        if (!rendersReference(scene)) continue;
        std::string path = renderReference(scene, results.facts[s], study.threads,
                                           directory + "/references", renderer, cancel, progress);
        if (!scene.reference.empty()) {
            keepReference(path, scene.reference);
            path = scene.reference;
        }
        results.references[s] = openReference(path, results.facts[s], scene.crops);
    }
}

/// Renders one run. `more`: arguments in addition to those of the plan.
void renderRun(const Results& results, const PlannedRun& run, const RunDirectory& directory,
               const std::vector<std::string>& more, const std::string& renderer,
               const std::atomic<bool>& cancel) {
    std::vector<std::string> arguments = run.arguments;
    arguments.insert(arguments.end(), more.begin(), more.end());
    // Preprocessing is done anew in each run, because its time belongs to the run.
    const std::string& method = results.study.methods[run.method].method;
    const bool chooses = method == kAuto;
    const auto needsCaches = [&] {
        const MethodRow& row = findMethod(method);
        return !needsOf(row, resolve(row, results.study.methods[run.method].assignments)).empty();
    };
    if (!chooses && needsCaches()) arguments.push_back("--prepare");
    arguments.insert(arguments.end(), {"--cache", directory.cache()});
    directory.render(renderer, results.study.scenes[run.scene].file, arguments, cancel);
}

std::string describe(const Study& study, const PlannedRun& run) {
    return study.scenes[run.scene].name + ", " + study.methods[run.method].name + ", seed " +
           std::to_string(run.seed);
}

/// Errors of a finished run's picture inside the scene's crops.
std::vector<ErrorMeasures> errorsInCrops(const Results& results, const PlannedRun& run,
                                         const std::string& path) {
    std::vector<ErrorMeasures> errors;
    const std::vector<StudyCrop>& crops = results.study.scenes[run.scene].crops;
    if (crops.empty()) return errors;
    const Image image = readImage(path);
    const PixelRect& rendered = results.facts[run.scene].crop;
    if (image.width != rendered.width() || image.height != rendered.height()) {
        throw InputError(path + ": expected a picture as large as the scene's others, for its " +
                         "crops, found another size; remove crops, or the method's own size");
    }
    for (std::size_t c = 0; c < crops.size(); ++c) {
        const ErrorReference& reference = results.references[run.scene].crops[c].picture;
        errors.push_back(reference.compare(cropped(image, crops[c].rect), path));
    }
    return errors;
}

/// Renders missing pictures with layers per technique.
void renderTechniques(Results& results, const std::string& directory, const std::string& renderer,
                      const std::atomic<bool>& cancel, Progress& progress) {
    for (const PlannedRun& run :
         planTechniques(results.study, results.facts, results.rendererHash)) {
        const RunDirectory folder(directory + "/techniques/" + run.id);
        if (!folder.complete()) {
            progress.phase("techniques: " + describe(results.study, run));
            renderRun(results, run, folder, {}, renderer, cancel);
        }
        results.techniques.push_back({run, folder.report(), folder.image()});
    }
}

/// Hash of the renderer's program and of the library with its code.
std::string hashOfRenderer(const std::string& program) {
    ContentHash hash;
    for (const std::string& file : {program, codeFile()}) {
        const std::string text = hashOfFile(file);
        hash.addValues(std::span<const char>(text));
    }
    return hash.hex();
}

}  // namespace

Execution execute(const Study& study, const std::string& directory, const std::string& renderer,
                  const std::atomic<bool>& cancel, Progress& progress) {
    Execution execution;
    Results& results = execution.results;
    results.study = study;
    results.machine = machineText();
    results.rendererHash = hashOfRenderer(renderer);
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
                           ": " + describe(study, run));
            renderRun(results, run, folder, {"--reference", results.references[run.scene].path},
                      renderer, cancel);
            ++execution.rendered;
        }
        results.runs.push_back({run, readCurve(folder.curve()), folder.report(), folder.image(),
                                errorsInCrops(results, run, folder.image())});
        if (results.runs.back().report.at("scene_hash") != results.facts[run.scene].contentHash) {
            throw InputError(study.scenes[run.scene].file +
                             ": expected it to stay as it is while the study runs, found it "
                             "changed; run the study again");
        }
    }
    renderTechniques(results, directory, renderer, cancel, progress);
    return execution;
}

}  // namespace lacuna

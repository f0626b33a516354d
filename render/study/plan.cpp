#include "render/study/plan.h"

#include "libcore/base/error.h"
#include "libcore/methods/registry.h"
#include "render/stage.h"
#include "render/study/content_hash.h"

namespace lacuna {

SceneFacts inspectScene(const StudyScene& scene, const ThreadPool& pool) {
    std::vector<std::string> arguments{scene.file, "-o", "x.exr", "--method", "pt"};
    arguments.insert(arguments.end(), scene.options.begin(), scene.options.end());
    const RenderOptions options = parseRenderArguments(arguments);
    SceneDescription description;
    pool.run([&] { description = describeScene(options); });

    SceneFacts facts;
    facts.contentHash = description.contentHash;
    facts.hash = description.contentHash;
    if (description.environment) facts.hash += fileHash(description.environment->file);
    const Camera::Film film = filmOf(options, description);
    facts.width = film.width;
    facts.height = film.height;
    facts.crop = options.crop.value_or(PixelRect{0, film.width, 0, film.height});
    facts.maxDepth = options.maxDepth ? int(*options.maxDepth)
                                      : description.maxDepth.value_or(WalkLimits{}.maxDepth);
    return facts;
}

std::string runId(const std::vector<std::string>& arguments,
                  const std::vector<std::string>& dependencies) {
    std::string text;
    for (const auto* list : {&arguments, &dependencies}) {
        for (const std::string& part : *list) text += part + '\0';
        text += '\n';
    }
    return contentHash(text).substr(0, 16);
}

std::vector<PlannedRun> planRuns(const Study& study, const std::vector<SceneFacts>& facts,
                                 const std::vector<std::string>& referenceHashes,
                                 const std::string& renderer, const std::string& machine) {
    std::vector<PlannedRun> runs;
    const std::size_t methodCount = study.methods.size();
    for (std::size_t s = 0; s < study.scenes.size(); ++s) {
        for (std::size_t k = 0; k < study.seeds.size(); ++k) {
            for (std::size_t m = 0; m < methodCount; ++m) {
                PlannedRun run;
                run.scene = s;
                run.method = (m + k) % methodCount;
                run.seed = study.seeds[k];
                const StudyMethod& method = study.methods[run.method];
                run.arguments = {"--method", method.method, "--seed", std::to_string(run.seed)};
                const auto append = [&](const std::vector<std::string>& more) {
                    run.arguments.insert(run.arguments.end(), more.begin(), more.end());
                };
                for (const std::string& assignment : method.assignments) {
                    append({"--set", assignment});
                }
                append(mergedOptions(study.scenes[s], method));
                append(study.effort);
                if (study.threads > 0) append({"--threads", std::to_string(study.threads)});
                run.id =
                    runId(run.arguments, {renderer, machine, facts[s].hash, referenceHashes[s]});
                runs.push_back(std::move(run));
            }
        }
    }
    return runs;
}

}  // namespace lacuna

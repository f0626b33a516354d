#include "render/study/plan.h"

#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"
#include "libcore/methods/registry.h"
#include "render/stage.h"

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
    if (description.environment) facts.hash += contentOf(*description.environment);
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
    ContentHash hash;
    hash.addValues(std::span<const char>(text));
    return hash.hex().substr(0, 16);
}

namespace {

void append(std::vector<std::string>& list, const std::vector<std::string>& more) {
    list.insert(list.end(), more.begin(), more.end());
}

/// A run without its id. `effort`: options that limit the run.
PlannedRun planRun(const Study& study, std::size_t scene, std::size_t method, std::uint64_t seed,
                   const std::vector<std::string>& effort) {
    const StudyMethod& m = study.methods[method];
    PlannedRun run{scene, method, seed, {"--method", m.method, "--seed", std::to_string(seed)}, ""};
    for (const std::string& assignment : m.assignments)
        append(run.arguments, {"--set", assignment});
    append(run.arguments, mergedOptions(study.scenes[scene], m));
    append(run.arguments, effort);
    if (study.threads > 0) append(run.arguments, {"--threads", std::to_string(study.threads)});
    return run;
}

}  // namespace

std::vector<PlannedRun> planRuns(const Study& study, const std::vector<SceneFacts>& facts,
                                 const std::vector<std::string>& referenceHashes,
                                 const std::string& renderer, const std::string& machine) {
    std::vector<PlannedRun> runs;
    const std::size_t methodCount = study.methods.size();
    for (std::size_t s = 0; s < study.scenes.size(); ++s) {
        for (std::size_t k = 0; k < study.seeds.size(); ++k) {
            for (std::size_t m = 0; m < methodCount; ++m) {
                PlannedRun run =
                    planRun(study, s, (m + k) % methodCount, study.seeds[k], study.effort);
                run.id =
                    runId(run.arguments, {renderer, machine, facts[s].hash, referenceHashes[s]});
                runs.push_back(std::move(run));
            }
        }
    }
    return runs;
}

std::vector<PlannedRun> planTechniques(const Study& study, const std::vector<SceneFacts>& facts,
                                       const std::string& renderer) {
    std::vector<PlannedRun> runs;
    if (!study.techniques) return runs;
    const std::vector<std::string> effort{
        "--iterations", std::to_string(study.techniques->iterations), "--techniques"};
    for (std::size_t s = 0; s < study.scenes.size(); ++s) {
        for (std::size_t m = 0; m < study.methods.size(); ++m) {
            PlannedRun run = planRun(study, s, m, study.seeds.front(), effort);
            run.id = runId(run.arguments, {renderer, facts[s].hash});
            runs.push_back(std::move(run));
        }
    }
    return runs;
}

}  // namespace lacuna

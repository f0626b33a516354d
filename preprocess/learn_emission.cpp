// (theory.md, "Learned emission")
#include "preprocess/learn_emission.h"

#include "preprocess/rounds_inl.h"

namespace lacuna {

namespace {
// Largest loss of a useful guide, relative to plain emission. A smaller gain pays neither for the look-ups nor for the
// fact that paths that training has not met become rarer.
constexpr double kEmissionWorthIt = 0.4;
}  // namespace

CacheStamp emissionStamp(const Settings& sceneInputs, const Settings& viewInputs,
                         std::uint64_t paths) {
    CacheStamp stamp{sceneInputs};
    stamp.inputs.insert(viewInputs.begin(), viewInputs.end());
    stamp.inputs["emission_paths"] = std::to_string(paths);
    return stamp;
}

EmissionTraining trainEmission(const Scene& scene, const Camera& camera, double aspect,
                               const WalkLimits& limits, std::uint64_t paths, std::uint64_t seed,
                               const ThreadPool& pool, const std::atomic<bool>& cancel) {
    EmissionTraining result;
    if (scene.lights().empty()) return result;
    std::shared_ptr<const Lights> lights;
    for (const Round& round : roundsOf(paths, kEmissionIteration)) {
        TrainingView view = trainingView(camera, aspect, limits, round.paths);
        view.guides.lights = lights;
        const Lights& used = lights ? *lights : scene.lights();
        const auto found = collectRound<EmissionSamples>(
            scene, view, round, seed, pool, cancel, result,
            [&](EmissionSamples& set, const PathEvent& event, float contribution) {
                set.add(event.path, event.counts, used, contribution, event.pixel);
            });
        result.learned = learnEmission(scene.lights(), found.train, found.heldOut, pool);
        // A guide from few paths may be worthless; the next round has more.
        if (const auto& guide = result.learned.guide) {
            lights = std::make_shared<const Lights>(scene.lights().guidedBy(guide));
        }
    }
    if (!(result.learned.heldOutLoss < kEmissionWorthIt)) result.learned.guide = nullptr;
    return result;
}

}  // namespace lacuna

#include "preprocess/learn_emission.h"

#include <algorithm>
#include <cmath>

#include "preprocess/collect_inl.h"

namespace lacuna {

namespace {
/// Of all paths, by round: later ones come by ways that earlier ones have found.
constexpr double kRounds[] = {0.15, 0.25, 0.6};
// Of plain emission's loss. What gains less pays neither for look-ups nor for the paths that training has
// not met, which become rarer.
constexpr double kWorthIt = 0.4;
constexpr std::uint32_t kIterationsPerRound = 0x1000;
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
    std::uint32_t first = kEmissionIteration;
    for (const double share : kRounds) {
        const auto wanted =
            std::max<std::uint64_t>(1, std::uint64_t(std::llround(share * double(paths))));
        TrainingView view = trainingView(camera, aspect, limits, wanted);
        view.guides.lights = lights;
        const Lights& used = lights ? *lights : scene.lights();
        Collected<EmissionSamples> found = collect<EmissionSamples>(
            scene, view, wanted, seed, first, pool, cancel,
            [&](EmissionSamples& set, const PathEvent& event, float contribution) {
                set.add(event.path, event.counts, used, contribution, event.pixel);
            });
        first += kIterationsPerRound;
        const float limit = found.train.outlierLimit();
        found.train.lowerTo(limit);
        found.heldOut.lowerTo(limit);
        result.trainPaths += found.train.size();
        result.heldOutPaths += found.heldOut.size();
        result.learned = learnEmission(scene.lights(), found.train, found.heldOut, pool);
        // Few paths may know nothing that is worth following; more may.
        if (const auto& guide = result.learned.guide) {
            lights = std::make_shared<const Lights>(scene.lights().guidedBy(guide));
        }
    }
    if (!(result.learned.heldOutLoss < kWorthIt)) result.learned.guide = nullptr;
    return result;
}

}  // namespace lacuna

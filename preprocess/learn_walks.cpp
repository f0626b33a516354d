#include "preprocess/learn_walks.h"

#include <algorithm>
#include <cmath>

#include "preprocess/collect_inl.h"

namespace lacuna {

namespace {
/// Of all paths, by round: later ones come by ways that earlier ones have found.
constexpr double kRounds[] = {0.15, 0.25, 0.6};
constexpr std::uint32_t kIterationsPerRound = 0x1000;
/// Of the loss without a guide, from which a walk goes without one: less does not pay for look-ups.
constexpr double kWorthIt = 0.97;
}  // namespace

CacheStamp walkStamp(const Settings& sceneInputs, const Settings& viewInputs, std::uint64_t paths,
                     const Techniques& techniques, const std::string& emission) {
    CacheStamp stamp{sceneInputs};
    stamp.inputs.insert(viewInputs.begin(), viewInputs.end());
    stamp.inputs["walk_paths"] = std::to_string(paths);
    stamp.inputs["techniques"] = TechniqueWorth::name(techniques);
    stamp.inputs["emission"] = emission;
    return stamp;
}

WalkTraining trainWalks(const Scene& scene, const Camera& camera, double aspect,
                        const WalkLimits& limits, const std::shared_ptr<const Lights>& lights,
                        const Techniques& techniques, std::uint64_t paths, std::uint64_t seed,
                        const ThreadPool& pool, const std::atomic<bool>& cancel) {
    WalkTraining result;
    if (scene.lights().empty()) return result;
    const TechniqueWorth worth = TechniqueWorth::of(techniques);
    std::uint32_t first = kWalkIteration;
    for (const double share : kRounds) {
        const auto wanted =
            std::max<std::uint64_t>(1, std::uint64_t(std::llround(share * double(paths))));
        TrainingView view = trainingView(camera, aspect, limits, wanted);
        view.guides = {lights, result.learned.guide};
        const Walker walker(scene, view.guides, view.camera, limits);
        Collected<WalkSamples> found = collect<WalkSamples>(
            scene, view, wanted, seed, first, pool, cancel,
            [&](WalkSamples& set, const PathEvent& event, float contribution) {
                set.add(event.path, event.counts, walker, worth, contribution, event.pixel);
            });
        first += kIterationsPerRound;
        const float limit = found.train.outlierLimit();
        found.train.lowerTo(limit);
        found.heldOut.lowerTo(limit);
        result.trainPaths += found.train.size();
        result.heldOutPaths += found.heldOut.size();
        result.learned = learnWalks(found.train, found.heldOut, pool);
    }
    LearnedWalks& learned = result.learned;
    if (!learned.guide) return result;
    std::array<bool, 2> worthIt{};
    for (std::size_t side = 0; side < 2; ++side) {
        worthIt[side] = learned.heldOutLoss[side] < kWorthIt;
    }
    if (!worthIt[0] && !worthIt[1]) {
        learned.guide = nullptr;
    } else if (!worthIt[0] || !worthIt[1]) {
        const Side side = worthIt[std::size_t(Side::Light)] ? Side::Light : Side::Eye;
        learned.guide = std::make_shared<const WalkGuide>(learned.guide->of(side));
    }
    return result;
}

}  // namespace lacuna

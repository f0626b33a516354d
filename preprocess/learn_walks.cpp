// (theory.md, "Guided walks")
#include "preprocess/learn_walks.h"

#include <array>

#include "preprocess/rounds_inl.h"

namespace lacuna {

namespace {
/// Largest loss of a useful guide, relative to none: a smaller gain does not pay for look-ups.
constexpr double kWalksWorthIt = 0.97;
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
    for (const Round& round : roundsOf(paths, kWalkIteration)) {
        TrainingView view = trainingView(camera, aspect, limits, round.paths);
        view.guides = {lights, result.learned.guide};
        const Walker walker(scene, view.guides, view.camera, limits);
        const auto found = collectRound<WalkSamples>(
            scene, view, round, seed, pool, cancel, result,
            [&](WalkSamples& set, const PathEvent& event, float contribution) {
                set.add(event.path, event.counts, walker, worth, contribution, event.pixel);
            });
        result.learned = learnWalks(found.train, found.heldOut, pool);
    }
    LearnedWalks& learned = result.learned;
    if (!learned.guide) return result;
    std::array<bool, 2> worthIt{};
    for (std::size_t side = 0; side < 2; ++side) {
        worthIt[side] = learned.heldOutLoss[side] < kWalksWorthIt;
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

#include "render/block_plan.h"

#include <algorithm>
#include <string>

#include "libcore/base/error.h"
#include "libcore/bidir/sampler.h"

namespace lacuna {
namespace {

/// Large enough that a warm-up costs below 1 % (theory.md, "Blocks").
constexpr std::uint64_t kBlockIterations = 64;
/// Where the method learns: an interrupted block is begun anew, so that it should be small, but
/// what is forgotten between blocks should cost little.
constexpr std::uint64_t kLearningBlockIterations = 16;
/// Where iterations share light paths: eight samples of the default number of iterations.
constexpr std::uint64_t kSharingBlockIterations = 8;

}  // namespace

BlockPlan planOf(const RenderOptions& options, const Method& method) {
    BlockPlan plan;
    plan.areSamples = method.sharesLightPaths();
    plan.iterations = plan.areSamples   ? kSharingBlockIterations
                      : method.learns() ? kLearningBlockIterations
                                        : kBlockIterations;
    if (options.blockIterations) plan.iterations = std::uint64_t(*options.blockIterations);
    plan.groupIterations = Sampler::groupOf(options.sampling);
    return plan;
}

std::uint64_t endOf(const RenderOptions& options, const BlockPlan& plan) {
    const std::uint64_t limit = options.iterations ? std::uint64_t(*options.iterations)
                                : options.timeSeconds || options.until || options.estimate
                                    ? 0
                                    : kDefaultIterations;
    if (!options.blocks) return limit;
    const std::uint64_t end = options.blocks->end * plan.iterations;
    if (!options.iterations) return end;
    if (options.blocks->begin * plan.iterations >= limit) {
        throw UsageError("--blocks: expected blocks below " +
                         std::to_string((limit + plan.iterations - 1) / plan.iterations) + " (" +
                         std::to_string(limit) + " iterations, " + std::to_string(plan.iterations) +
                         " to a block), found " + options.blocksText +
                         "; ask for more --iterations");
    }
    return std::min(end, limit);
}

}  // namespace lacuna

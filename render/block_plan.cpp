#include "render/block_plan.h"

#include <algorithm>
#include <string>

#include "libcore/base/error.h"
#include "libcore/bidir/sampler.h"

namespace lacuna {
namespace {

/// Large enough for a warm-up to cost less than 1 % (theory.md, "Blocks").
constexpr std::uint64_t kBlockIterations = 64;
/// For methods that learn. Blocks should be small, because an interrupted block starts anew, but
/// large enough that forgetting between blocks costs little.
constexpr std::uint64_t kLearningBlockIterations = 16;
/// For iterations that share light paths: eight samples in the default number of iterations.
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

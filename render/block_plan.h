// How a render's iterations are cut into blocks, and which of them are asked for. (theory.md,
// "Blocks")
#pragma once

#include <cstdint>

#include "libcore/bidir/film.h"
#include "libcore/bidir/method.h"
#include "render/options.h"

namespace lacuna {

/// Of a picture, where no option says how many.
constexpr std::uint64_t kDefaultIterations = 64;

/// The method's blocks, or those of --block-iterations.
BlockPlan planOf(const RenderOptions& options, const Method& method);

/// Behind the last iteration that is asked for; 0: time or error alone end the render. Throws UsageError
/// for blocks behind the picture's end.
std::uint64_t endOf(const RenderOptions& options, const BlockPlan& plan);

}  // namespace lacuna

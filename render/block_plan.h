// The division of a render's iterations into blocks, and the range of iterations to render.
// (theory.md, "Blocks")
#pragma once

#include <cstdint>

#include "libcore/bidir/film.h"
#include "libcore/bidir/method.h"
#include "render/options.h"

namespace lacuna {

/// Iterations of a picture if no option determines the number.
constexpr std::uint64_t kDefaultIterations = 64;

/// The plan of the method, or of --block-iterations.
BlockPlan planOf(const RenderOptions& options, const Method& method);

/// One past the last requested iteration; 0: only time or error end the render. Throws UsageError for blocks beyond the
/// picture's end.
std::uint64_t endOf(const RenderOptions& options, const BlockPlan& plan);

}  // namespace lacuna

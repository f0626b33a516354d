// Makes a picture from a command: all work of lacuna-render after its options are read.
#pragma once

#include <atomic>
#include <optional>

#include "libcore/tool/progress.h"
#include "render/options.h"
#include "render/ranks/ranks.h"
#include "render/rendered.h"

namespace lacuna {

/// Chooses a method if none is named, loads or makes the caches that it needs, renders, and writes
/// the results that the options request. On ranks other than the first it works for rank 0 and
/// returns nothing. Once `interrupted` is set, it ends with the picture so far. Throws UsageError,
/// InputError, RunError, and InterruptedError if there is no picture yet.
std::optional<Rendered> renderPicture(RenderOptions& options, const Ranks& ranks,
                                      const std::atomic<bool>& interrupted, Progress& progress);

}  // namespace lacuna

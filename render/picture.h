// A picture from what a command says: everything that lacuna-render does once its options are read.
#pragma once

#include <atomic>
#include <optional>

#include "libcore/tool/progress.h"
#include "render/options.h"
#include "render/ranks/ranks.h"
#include "render/rendered.h"

namespace lacuna {

/// Chooses a method where none is named, loads or makes the caches it needs, renders, and writes
/// what the options ask for. On ranks other than the first: works for rank 0, then nothing. Once
/// `interrupted` is set it ends with what there is. Throws UsageError, InputError, RunError;
/// InterruptedError where nothing is there yet.
std::optional<Rendered> renderPicture(RenderOptions& options, const Ranks& ranks,
                                      const std::atomic<bool>& interrupted, Progress& progress);

}  // namespace lacuna

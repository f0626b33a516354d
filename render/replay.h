// --replay: computes one sample alone and prints its vertices and contributions.
#pragma once

#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "render/options.h"

namespace lacuna {

/// Prints to stdout and needs no output file. Returns the exit code. Throws UsageError if there is
/// no such sample.
int replay(const RenderOptions& options, const MethodRow& row, const Settings& settings,
           const ThreadPool& pool);

}  // namespace lacuna

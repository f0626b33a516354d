// --replay: one sample run alone, printed vertex by vertex and contribution by contribution.
#pragma once

#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "render/options.h"

namespace lacuna {

/// Prints to stdout; needs no output file. Throws UsageError where there is no such sample.
int replay(const RenderOptions& options, const MethodRow& row, const Settings& settings,
           const ThreadPool& pool);

}  // namespace lacuna

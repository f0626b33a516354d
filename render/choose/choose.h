// `--method auto`: chooses the method that renders this scene best within its budget, by a pilot
// whose samples are discarded. (theory.md, "auto")
#pragma once

#include <atomic>
#include <functional>

#include "libcore/image/image.h"
#include "libcore/tool/progress.h"
#include "render/choose/choice.h"
#include "render/options.h"
#include "render/stage.h"

namespace lacuna {

/// The names of the candidates: "bpt, pt, ..", including those that need --allow-bias.
std::string triedMethods();

/// Chooses a method for a stage that was loaded for `bpt`. Its techniques are the allowed ones. With --time, the choice
/// depends on measured times; else it is a function of the command and the scene. Caches of candidates that need
/// training are read or made, and are kept. `show` is called with the first small picture, enlarged to the requested
/// size, within about a second. Throws InterruptedError once `cancel` is set.
RowChoice chooseMethod(const RenderOptions& options, const Stage& stage, const ThreadPool& pool,
                       const std::atomic<bool>& cancel, Progress& progress,
                       const std::function<void(const Image&)>& show);

}  // namespace lacuna

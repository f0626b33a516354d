// `--method auto`: which method renders this scene best in what it may take, found by a pilot whose
// samples are thrown away. (theory.md, "auto")
#pragma once

#include <atomic>
#include <functional>

#include "libcore/image/image.h"
#include "libcore/tool/progress.h"
#include "render/choose/choice.h"
#include "render/options.h"
#include "render/stage.h"

namespace lacuna {

/// The names of the rows that are tried: "bpt, pt, ..", with those that only --allow-bias lets in.
std::string triedMethods();

/// Chooses for a stage that was loaded for `bpt`, whose techniques are those that may be used at
/// all. With --time the clock has a say; else the choice is a function of the command and the scene. Caches of candidates that are trained are
/// read or made, and stay. `show` is called with the first small picture, as large as the one that
/// is asked for: something to look at within a second. Throws Error 130 once `cancel` is set.
RowChoice chooseMethod(const RenderOptions& options, const Stage& stage, const ThreadPool& pool,
                       const std::atomic<bool>& cancel, Progress& progress,
                       const std::function<void(const Image&)>& show);

}  // namespace lacuna

// Guides that were learned from a scene: how light subpaths begin, and where walks go on to.
#pragma once

#include <memory>

#include "libcore/bidir/walk_guide.h"
#include "libcore/scene/light.h"

namespace lacuna {

struct Guides {
    std::shared_ptr<const Lights> lights = nullptr;    ///< guided; null: the scene's own
    std::shared_ptr<const WalkGuide> walks = nullptr;  ///< null: directions are the BSDFs' alone
};

}  // namespace lacuna

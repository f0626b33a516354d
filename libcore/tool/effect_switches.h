// --effect NAME=on|off: effects forced on or off, whatever the scene needs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libcore/methods/registry.h"
#include "libcore/scene/description.h"
#include "libcore/tool/effects.h"

namespace lacuna {

struct EffectSwitch {
    std::string name;  ///< in the output of --effects
    bool on = false;
};

/// Parses texts NAME=on|off, in their order. A later text of the same name replaces the earlier
/// one. Throws UsageError for other texts.
std::vector<EffectSwitch> parseEffectSwitches(std::span<const std::string> texts);

/// The objects that switches change.
struct SwitchTargets {
    SceneDescription& scene;
    double& lensRadius;
    Techniques* techniques;  ///< null without a method
};

/// Removes an effect from the scene, or makes its code run although the scene does not need it. (A
/// white texture, a normal map that tilts nothing or a mask that hides nothing leaves the picture
/// the same.) `effects` are the rows that effectsOf() found before. They are updated to tell what
/// is done and why, and are `forced` where a switch changed something. Returns a warning for every
/// effect that is off although the scene needs it. Throws UsageError for unknown names and for
/// effects that cannot be forced on.
std::vector<std::string> forceEffects(std::span<const EffectSwitch> switches,
                                      const SwitchTargets& targets, std::vector<Effect>& effects);

}  // namespace lacuna

// --effect NAME=on|off: effects forced on or off, whatever the scene calls for.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libcore/methods/registry.h"
#include "libcore/scene/description.h"
#include "libcore/tool/effects.h"

namespace lacuna {

struct EffectSwitch {
    std::string name;  ///< as --effects prints it
    bool on = false;
};

/// Of texts NAME=on|off, in their order; a later one of the same name takes the earlier one's
/// place. Throws UsageError for another text.
std::vector<EffectSwitch> parseEffectSwitches(std::span<const std::string> texts);

/// What the switches change besides the scene.
struct SwitchTargets {
    SceneDescription& scene;
    double& lensRadius;
    Techniques* techniques;  ///< null: there is no method
};

/// Changes the scene so that an effect is not there any more, or so that its code runs though
/// nothing calls for it (a white texture, a normal map that tilts nothing, a mask that hides
/// nothing: the picture stays the same). `effects` is what effectsOf() found before; its rows then
/// say what is done and why, and are `forced` where a switch changed something. Returns a warning
/// for every effect that is off though the scene calls for it. Throws UsageError for unknown names
/// and for what cannot be forced on.
std::vector<std::string> forceEffects(std::span<const EffectSwitch> switches,
                                      const SwitchTargets& targets, std::vector<Effect>& effects);

}  // namespace lacuna

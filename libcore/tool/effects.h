// The effects that a scene needs: which are simulated, which are left out, and why.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libcore/methods/registry.h"
#include "libcore/scene/description.h"

namespace lacuna {

struct Effect {
    std::string name;  ///< stable, for scripts: "rough_refraction"
    bool simulated = false;
    std::string reason;   ///< what in the scene needs it, or what is missing
    bool forced = false;  ///< on or off against the scene's needs
    bool ofScene = true;  ///< false: one of the method's techniques
};

/// One row per effect, always all of them, in a fixed order. `lensRadius`: that of the render. With
/// a method, its techniques follow.
std::vector<Effect> effectsOf(const SceneDescription& scene, double lensRadius,
                              const MethodRow* method);

/// The rows of a method's techniques, derived from those of the scene.
std::vector<Effect> techniqueEffects(const MethodRow& method, const SceneDescription& scene,
                                     std::span<const Effect> ofScene);

/// The table that --effects prints.
std::string effectsText(const std::vector<Effect>& effects);

}  // namespace lacuna

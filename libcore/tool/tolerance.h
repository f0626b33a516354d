// --tolerance E: leaves out parts of the scene that provably add no more than E.
//
//   layers, lobes  a clearcoat, a dielectric layer, metal or glass in a mixture, if its factor w is
//                  at most E (textures can only lower it). The light that a surface scatters from
//                  any one direction changes by at most w of that light: the part itself reflects
//                  no more, and the lobes under or beside it gain no more than that.
//   lights         the weakest ones, as long as all of them together emit, in each channel, at most
//                  E times the power of those that stay. Their powers are estimated from above,
//                  those of the others from below (a texture's emission: at most the factor, at
//                  least none; environments and directional lights stay, and count as nothing).
//
// Both bound energies: that of one scattering event, and that which enters the scene. They do not
// bound pixels: a corner that only a weak lamp reaches turns black. Hence the default is 0, which
// leaves out nothing (a factor of exactly 0 is no effect anyway).
#pragma once

#include <string>
#include <vector>

#include "libcore/scene/description.h"
#include "libcore/tool/effects.h"

namespace lacuna {

/// Largest E that is accepted: more would not be a small loss.
inline constexpr double kMaxTolerance = 0.1;

/// Leaves out parts of the scene; 0 <= tolerance <= kMaxTolerance. Returns a line for each kind of
/// part that was left out, with its largest weight or share. Throws nothing.
std::vector<std::string> leaveOutWithin(double tolerance, SceneDescription& scene);

/// Calls leaveOutWithin(), adds its lines to `warnings`, and returns effectsOf() the result. Rows
/// that are left out because of the tolerance say so.
std::vector<Effect> effectsWithin(double tolerance, SceneDescription& scene, double lensRadius,
                                  const MethodRow* method, std::vector<std::string>& warnings);

}  // namespace lacuna

// --tolerance E: what is there, but adds provably no more than E, is left out as well.
//
//   layers, lobes  a clearcoat, a dielectric layer, metal or glass in a mixture, each where its
//                  factor w is at most E (textures can only lower it). What a surface scatters of
//                  the light from any one direction changes by at most w of that light: the part
//                  itself holds no more, and what is under it or beside it gets no more than that
//                  back.
//   lights         the weakest ones, as long as all of them together emit, in each channel, at most
//                  E of what those that stay do. Their powers are taken from above, the others'
//                  from below (a texture's emission: at most the factor, at least none;
//                  environments and directional lights stay, and count as nothing).
//
// Both are bounds on energy, of one scattering and of what enters the scene. They bound no pixel: a
// corner that only a weak lamp reaches turns black. Hence the default of 0, which leaves out
// nothing (a factor of exactly 0 is no effect to begin with).
#pragma once

#include <string>
#include <vector>

#include "libcore/scene/description.h"
#include "libcore/tool/effects.h"

namespace lacuna {

/// Largest E: beyond it nobody would call what is left out small.
inline constexpr double kMaxTolerance = 0.1;

/// Changes the scene; 0 <= tolerance <= kMaxTolerance. Returns a line for each kind of thing that
/// was left out, with its largest weight or share. Throws nothing.
std::vector<std::string> leaveOutWithin(double tolerance, SceneDescription& scene);

/// effectsOf() after leaveOutWithin(), whose lines are added to `warnings`; rows that are left out
/// for that reason say so.
std::vector<Effect> effectsWithin(double tolerance, SceneDescription& scene, double lensRadius,
                                  const MethodRow* method, std::vector<std::string>& warnings);

}  // namespace lacuna

// Which glass has a density.
#pragma once

namespace lacuna {

/// Whether refraction by a solid of this roughness and index has a density. It has none where it is
/// smooth, nor where it hardly bends light, ior 1 above all: both count as smooth.
bool refractsRoughly(float roughness, float ior);

}  // namespace lacuna

// Which glass counts as rough.
#pragma once

namespace lacuna {

/// Whether refraction by a solid of this roughness and index has a density. It has none if the
/// surface is smooth or hardly bends light, as with ior 1; both count as smooth.
bool refractsRoughly(float roughness, float ior);

}  // namespace lacuna

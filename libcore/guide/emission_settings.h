// Whether light subpaths begin by power or as learned, and how that is learned: one table that rows,
// lacuna-train and the cache's key share. (theory.md, "Learned emission")
#pragma once

#include <cstdint>

#include "libcore/base/options.h"

namespace lacuna {

enum class Emission { Plain, Learned };

struct EmissionSettings {
    Emission emission = Emission::Plain;
    std::uint64_t paths = 0;  ///< 0: as many as go with the rest (guidePaths)
};

/// `standard`: what a row does where nobody says anything.
inline OptionTable<EmissionSettings> emissionOptions(Emission standard) {
    return OptionTable<EmissionSettings>({.emission = standard})
        .choice<Emission>(
            "emission", &EmissionSettings::emission,
            {{"plain", Emission::Plain}, {"learned", Emission::Learned}},
            "light paths leave lamps by power and in all directions, or as paths that "
            "reached the picture taught beforehand")
        .integer(
            "emission_paths", &EmissionSettings::paths, 0, 1e8, "full paths",
            "to learn emission from; 0: half as many as train.paths, 500000 where nothing else "
            "is trained")
        .standardText("half of train.paths");
}

/// How many paths a guide is learned from: so many as are asked for, or (0) what goes with so many for
/// subspaces (0: none).
inline std::uint64_t guidePaths(std::uint64_t asked, std::uint64_t trainingPaths) {
    if (asked > 0) return asked;
    return trainingPaths > 0 ? (trainingPaths + 1) / 2 : 500'000;
}

}  // namespace lacuna

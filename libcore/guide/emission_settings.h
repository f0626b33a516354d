// Whether light subpaths begin by power or as learned, and how that is learned: one table that rows,
// lacuna-train and the cache's key share. (theory.md, "Learned emission")
#pragma once

#include <cstdint>

#include "libcore/guide/guide_paths.h"

namespace lacuna {

enum class Emission { Plain, Learned };

struct EmissionSettings {
    Emission emission = Emission::Plain;
    std::uint64_t paths = 0;  ///< 0: as many as go with the rest (guidePaths)
};

/// `standard` is the row's default.
inline OptionTable<EmissionSettings> emissionOptions(Emission standard) {
    return withGuidePaths(
        OptionTable<EmissionSettings>({.emission = standard})
            .choice<Emission>("emission", &EmissionSettings::emission,
                              {{"plain", Emission::Plain}, {"learned", Emission::Learned}},
                              "how light paths begin: by power and in all directions, or as "
                              "learned beforehand from paths that reached the picture"),
        "emission_paths", &EmissionSettings::paths, "emission");
}

}  // namespace lacuna

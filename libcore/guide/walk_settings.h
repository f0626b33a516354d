// Whether walks go on as BSDFs say or as learned, and how that is learned: one table that rows,
// lacuna-train and the cache's key share. (theory.md, "Guided walks")
#pragma once

#include <cstdint>

#include "libcore/guide/guide_paths.h"

namespace lacuna {

enum class Walks { Plain, Guided };

struct WalkSettings {
    Walks walks = Walks::Plain;
    std::uint64_t paths = 0;  ///< 0: as many as go with the rest (guidePaths)
};

/// `standard` is the row's default.
inline OptionTable<WalkSettings> walkOptions(Walks standard) {
    return withGuidePaths(
        OptionTable<WalkSettings>({.walks = standard})
            .choice<Walks>("walks", &WalkSettings::walks,
                           {{"plain", Walks::Plain}, {"guided", Walks::Guided}},
                           "how walks go on: as BSDFs sample them, or by a learned share along a "
                           "guide, learned beforehand from paths that reached the picture"),
        "walk_paths", &WalkSettings::paths, "walks");
}

}  // namespace lacuna

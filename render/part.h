// A part of a picture: what some of its iterations add up to, and which render they are of.
// Checkpoints hold one, and what --blocks writes; lacuna-merge puts them together.
// (files.md, "Parts")
#pragma once

#include <cstdint>
#include <string>

#include "libcore/bidir/film.h"
#include "libcore/bidir/statistics.h"
#include "libcore/cache/cache_name.h"

namespace lacuna {

struct Part {
    CacheStamp inputs;  ///< of the render: whatever its pixels depend on but the iterations' number
    int width = 0, height = 0;
    BlockPlan plan;
    std::uint64_t firstBlock = 0;
    Film::State sums;
    double seconds = 0.0;  ///< that its iterations and warm-ups took
    IterationStatistics statistics;

    std::uint64_t iterations() const;
};

/// Adds channels `sum.*` and attributes `part*`, with a hash of both, to an image of that size.
void addPart(LayeredImage& image, const Part& part);

/// Of everything about the part that the image holds: what addPart writes as `partHash`. Throws
/// std::out_of_range where its attributes are missing.
std::string partHash(const LayeredImage& image);

/// Takes them out again. Throws InputError if there is none, or not as it was written; `path` is
/// the file's.
Part takePart(LayeredImage& image, const std::string& path);

}  // namespace lacuna

// A part of a picture: the sums of some of its iterations, and the inputs of their render.
// Checkpoints and the files of --blocks hold a part; lacuna-merge merges parts. (files.md, "Parts")
#pragma once

#include <cstdint>
#include <string>

#include "libcore/bidir/film.h"
#include "libcore/bidir/statistics.h"
#include "libcore/cache/cache_name.h"

namespace lacuna {

struct Part {
    CacheStamp inputs;  ///< of the render: everything except the number of iterations
    int width = 0, height = 0;
    BlockPlan plan;
    std::uint64_t firstBlock = 0;
    Film::State sums;
    double seconds = 0.0;  ///< of its iterations and warm-ups
    IterationStatistics statistics;

    std::uint64_t iterations() const;
};

/// Adds channels `sum.*` and attributes `part*`, with a hash of both, to an image of the part's
/// size.
void addPart(LayeredImage& image, const Part& part);

/// Hash of the part in the image, which addPart writes as `partHash`. Throws std::out_of_range if
/// its attributes are missing.
std::string partHash(const LayeredImage& image);

/// Removes the part from the image and returns it. Throws InputError, which names the file `path`,
/// if there is none or it is damaged.
Part takePart(LayeredImage& image, const std::string& path);

}  // namespace lacuna

// Merges the parts of one picture.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/bidir/film_sum.h"

namespace lacuna {

class ThreadPool;

struct Merged {
    LayeredImage image;  ///< picture, variance, layers; features and header are the first part's
    FilmSum::MeanColour mean;
    std::uint64_t blocks = 0;  ///< number of blocks begun
    std::uint64_t iterations = 0;
    std::vector<std::string> warnings;
};

/// Merges parts, given in any order. Throws InputError if a file is no part, or if two parts belong
/// to different renders or contain the same block. Without `gaps`, also throws if a block is
/// missing before another.
Merged mergeParts(const std::vector<std::string>& paths, bool gaps, const ThreadPool& pool);

}  // namespace lacuna

// Parts of one picture, put together again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/bidir/film_sum.h"

namespace lacuna {

class ThreadPool;

struct Merged {
    LayeredImage image;  ///< picture, variance, layers; features and header of the first part
    FilmSum::MeanColour mean;
    std::uint64_t blocks = 0;  ///< begun ones
    std::uint64_t iterations = 0;
    std::vector<std::string> warnings;
};

/// The parts in any order. Throws InputError if one is no part, two are of different renders or
/// hold the same block; without `gaps`, if a block is missing in front of another.
Merged mergeParts(const std::vector<std::string>& paths, bool gaps, const ThreadPool& pool);

}  // namespace lacuna

// A trial: a candidate renders a small picture of the scene, to measure its noise and cost. The
// samples are discarded. (theory.md, "auto")
#pragma once

#include <atomic>
#include <cstdint>

#include "libcore/bidir/small_film.h"
#include "render/caches.h"
#include "render/choose/judge.h"
#include "render/options.h"
#include "render/stage.h"

namespace lacuna {

struct Trial {
    HalfPictures halves;
    std::uint64_t iterations = 0;  ///< in both halves together
    double rays = 0.0;             ///< per iteration of the whole picture
    double seconds = 0.0;          ///< likewise, on this machine without other load
    /// For a row that merges: contributions, by pixel, of paths that only merges can make. Else
    /// empty.
    std::vector<Rgb> onlyMerged = {};
};

/// The mean of both halves, enlarged to the size of `crop` by nearest neighbours.
Image enlarged(const SmallFilm& small, const HalfPictures& halves, const PixelRect& crop);

/// Renders pairs of iterations until `rays` rays are traced, at least one pair. `poolScale`: factor
/// of the time that a row needs to prepare its pool, for the whole picture. False if cancelled.
bool runTrial(const Stage& stage, const SmallFilm& small, const MethodRow& row,
              const Settings& settings, const Caches& caches, double poolScale, Sampling sampling,
              std::uint64_t seed, double rays, const ThreadPool& pool,
              const std::atomic<bool>& cancel, Trial& result);

}  // namespace lacuna

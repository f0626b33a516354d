// A candidate renders a small picture of the scene, whose samples are thrown away: what its noise
// is and what it costs. (theory.md, "auto")
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
    double rays = 0.0;             ///< of an iteration of the whole picture
    double seconds = 0.0;          ///< likewise, on this machine, had it nothing else to do
    /// Of a row that merges: what paths that nothing else can make add to a pixel. Else empty.
    std::vector<Rgb> onlyMerged = {};
};

/// The mean of both halves in the size of `crop`: each pixel shows the small one that covers it.
Image enlarged(const SmallFilm& small, const HalfPictures& halves, const PixelRect& crop);

/// Pairs of iterations until `rays` rays are traced, at least one. What a row prepares from its pool
/// takes `poolScale` times as long for the whole picture. False if cancelled.
bool runTrial(const Stage& stage, const SmallFilm& small, const MethodRow& row,
              const Settings& settings, const Caches& caches, double poolScale, Sampling sampling,
              std::uint64_t seed, double rays, const ThreadPool& pool,
              const std::atomic<bool>& cancel, Trial& result);

}  // namespace lacuna

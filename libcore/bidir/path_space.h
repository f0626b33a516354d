// The space that paths live in, as far as methods look at it while they prepare: scenes
// (scene_paths.h), and finite spaces that tests sum up completely.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/bidir/path.h"
#include "libcore/bidir/statistics.h"

namespace lacuna {

class ThreadPool;

class PathSpace {
  public:
    virtual ~PathSpace() = default;

    /// Replaces `out` by an eye subpath through a uniform point of the whole film.
    virtual void traceEye(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const = 0;

    /// The light that arrives from a light subpath's last vertex at an eye subpath's last vertex.
    /// Visibility, and absorption in coloured glass between the two, are left out.
    struct Arrival {
        Rgb flow;             ///< beta rho at the light's end
        Rgb scattered;        ///< flow times rho at the eye's end, where asked for
        double geometry = 0;  ///< G
    };
    /// `throughEye` asks for Arrival::scattered. All is zero where light comes from behind the
    /// eye's last vertex and is not scattered there.
    virtual Arrival arrival(Subpath light, Subpath eye, bool throughEye) const = 0;
    virtual bool visible(const PathVertex& light, const PathVertex& eye, RayTally& tally) const = 0;
    /// Distance along a unit direction from a point in empty space to the first surface; infinite
    /// where there is none.
    virtual float reach(const Vec3& origin, const Vec3& direction, RayTally& tally) const = 0;
};

/// The data that a method may use before and after an iteration's eye paths, and the statistics
/// that it adds to.
struct IterationContext {
    const PathSpace& space;
    const ThreadPool& threads;
    std::uint64_t seed;
    std::uint32_t generation;  ///< counts all iterations, warm-ups too: addresses random numbers
    std::uint64_t filmPixels;  ///< of the whole film, whatever the crop
    IterationStatistics& statistics;
};

}  // namespace lacuna

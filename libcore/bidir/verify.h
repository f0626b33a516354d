// The weight computed a second time: by full products in log space, from geometry and
// materials alone.
//
// misWeight (mis.h) sweeps ratios of densities that the walks stored. Nothing here reads a stored
// density: positions, normals, stored unit directions inside a subpath, events and materials give
// every p(y), p(z), every roulette probability and every light throughput anew, and each strategy's
// product is formed as a whole. Where both agree, no error of bookkeeping can have touched the
// weight. Weights from a wrong but consistent ratio still sum to one, but they fail here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/bidir/integrator.h"

namespace lacuna {

/// Weight of the technique that made this path. Events are smooth at a connection's ends and at a merged vertex, and a
/// connection's edge has no stored direction. May be NaN only where a density is.
double misWeightByProducts(const Walker& walker, const FullPath& path,
                           const TechniqueCounts& counts, Technique made);

/// Compares the weight of every path it is shown; called from many threads at once.
class WeightVerifier {
  public:
    /// The objects that the walker refers to must outlive the verifier.
    WeightVerifier(const Walker& walker, const ThreadPool& pool);

    void check(const PathEvent& event);

    struct Result {
        double maxDifference = 0.0;  ///< a weight that is not a number counts as 1
        std::uint64_t paths = 0;
        std::uint64_t notNumbers = 0;
        std::string replay;  ///< --replay argument of the largest difference
    };
    /// Called between iterations. The same for any number of threads.
    Result result() const;

  private:
    struct Worst {
        double difference = -1.0;
        Sample sample;

        /// Whether the difference is larger or, where two are equal, the sample is earlier.
        bool worseThan(const Worst& other) const;
    };
    struct alignas(64) Slot {  // one per thread
        std::uint64_t paths = 0, notNumbers = 0;
        Worst worst;
    };

    const Walker walker_;
    const ThreadPool& pool_;
    int filmWidth_;
    std::vector<Slot> slots_;
};

}  // namespace lacuna

// Statistics of an iteration: its counts, and where its time went.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libcore/base/stopwatch.h"
#include "libcore/bidir/technique_clock.h"
#include "libcore/scene/ray.h"

namespace lacuna {

/// Counts of an iteration, merged in an order that does not depend on threads.
struct IterationStatistics {
    static constexpr std::size_t kReplaysKept = 8;

    RayCounts rays{};
    std::uint64_t invalidSamples = 0;
    std::vector<std::string> invalidReplays;  ///< --replay arguments of the first few
    std::map<std::string, double> phaseSeconds;
    TechniqueSeconds techniqueSeconds{};  ///< where --techniques asks for them
    /// The most that any iteration held at one time, by name: numbers of things, and bytes.
    std::map<std::string, std::uint64_t> held;

    std::uint64_t totalRays() const;
    /// Notes that `number` of `what` were held at one time. Keeps the largest number.
    void hold(const std::string& what, std::uint64_t number);
    void add(const IterationStatistics& other);
    void add(const RayTally& tally);
    void add(const TechniqueSeconds& seconds);
};

/// Adds the time between construction and destruction to a phase.
class PhaseTimer {
  public:
    PhaseTimer(IterationStatistics& statistics, const char* phase)
        : watch_(statistics.phaseSeconds[phase]) {}

  private:
    Stopwatch watch_;
};

}  // namespace lacuna

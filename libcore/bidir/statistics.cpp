#include "libcore/bidir/statistics.h"

#include <algorithm>

namespace lacuna {

std::uint64_t IterationStatistics::totalRays() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t n : rays) sum += n;
    return sum;
}

void IterationStatistics::hold(const std::string& what, std::uint64_t number) {
    std::uint64_t& most = held[what];
    most = std::max(most, number);
}

void IterationStatistics::add(const RayTally& tally) {
    for (std::size_t i = 0; i < kRayKinds; ++i) rays[i] += tally.counts[i];
}

void IterationStatistics::add(const TechniqueSeconds& seconds) {
    for (std::size_t i = 0; i < seconds.size(); ++i) techniqueSeconds[i] += seconds[i];
}

void IterationStatistics::add(const IterationStatistics& other) {
    for (std::size_t i = 0; i < kRayKinds; ++i) rays[i] += other.rays[i];
    invalidSamples += other.invalidSamples;
    for (const std::string& r : other.invalidReplays) {
        if (invalidReplays.size() < kReplaysKept) invalidReplays.push_back(r);
    }
    for (const auto& [phase, seconds] : other.phaseSeconds) phaseSeconds[phase] += seconds;
    add(other.techniqueSeconds);
    for (const auto& [what, number] : other.held) hold(what, number);
}

}  // namespace lacuna

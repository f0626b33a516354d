// Where a task's time goes: by group of techniques, and into walks.
#pragma once

#include <array>
#include <chrono>

#include "libcore/bidir/technique_group.h"

namespace lacuna {

/// Seconds of threads: by group, then those of the walks that all techniques share.
using TechniqueSeconds = std::array<double, TechniqueGroup::kCount + 2>;
inline constexpr std::size_t kEyeWalks = TechniqueGroup::kCount;
inline constexpr std::size_t kLightWalks = TechniqueGroup::kCount + 1;

/// Off unless --techniques asks for it: two readings of the clock take a twentieth of a
/// connection's time.
class TechniqueClock {
  public:
    void switchOn() { on_ = true; }
    bool isOn() const { return on_; }
    const TechniqueSeconds& seconds() const { return seconds_; }

    /// Begins the time of the next lap.
    void start() {
        if (on_) last_ = Clock::now();
    }
    /// Gives the time since the last start() or lap() to the group that `group()` names.
    template <class Group>
    void lap(const Group& group) {
        if (on_) seconds_[group().index()] += passed();
    }
    /// Likewise to kEyeWalks or kLightWalks.
    void lapOfWalks(std::size_t which) {
        if (on_) seconds_[which] += passed();
    }
    /// Shares that time among the groups group(i), i in [0, n). Does nothing for n = 0.
    template <class Group>
    void lapAmong(std::size_t n, const Group& group) {
        if (!on_ || n == 0) return;
        const double each = passed() / double(n);
        for (std::size_t i = 0; i < n; ++i) seconds_[group(i).index()] += each;
    }

  private:
    using Clock = std::chrono::steady_clock;
    double passed() {
        const Clock::time_point now = Clock::now(), before = last_;
        last_ = now;
        return std::chrono::duration<double>(now - before).count();
    }

    bool on_ = false;
    Clock::time_point last_;
    TechniqueSeconds seconds_{};
};

}  // namespace lacuna

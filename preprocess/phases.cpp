#include "preprocess/phases.h"

#include <chrono>

namespace lacuna {

void Phases::run(const std::string& name, const std::function<void()>& work) {
    using Clock = std::chrono::steady_clock;
    if (announce_) announce_(name);
    const Clock::time_point start = Clock::now();
    work();
    seconds_[name] += std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace lacuna

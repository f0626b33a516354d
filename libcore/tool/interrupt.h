// SIGINT and SIGTERM: the first signal asks for an orderly end, the second ends the process at
// once.
#pragma once

#include <signal.h>

#include <atomic>

namespace lacuna {

/// Installs the handlers for its lifetime. There must be only one at a time.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    /// Becomes true at the first signal.
    const std::atomic<bool>& requested() const;

  private:
    struct sigaction oldInt_ {
    }, oldTerm_{};
};

}  // namespace lacuna

#include "libcore/tool/interrupt.h"

#include <unistd.h>

namespace lacuna {
namespace {

// The one variable that a signal handler can reach.
std::atomic<bool> interruptRequested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not take a lock");

extern "C" void lacunaOnInterrupt(int) {
    if (interruptRequested.exchange(true)) _exit(kInterruptedExit);
}

}  // namespace

InterruptGuard::InterruptGuard() {
    interruptRequested = false;
    struct sigaction action {};
    action.sa_handler = lacunaOnInterrupt;
    action.sa_flags = SA_RESTART;  // no library of ours has to know about EINTR
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, &oldInt_);
    sigaction(SIGTERM, &action, &oldTerm_);
}

InterruptGuard::~InterruptGuard() {
    sigaction(SIGINT, &oldInt_, nullptr);
    sigaction(SIGTERM, &oldTerm_, nullptr);
}

const std::atomic<bool>& InterruptGuard::requested() const {
    return interruptRequested;
}

}  // namespace lacuna

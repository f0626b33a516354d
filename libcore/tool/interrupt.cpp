#include "libcore/tool/interrupt.h"

#include <unistd.h>

#include <string_view>

#include "libcore/base/error.h"
#include "libcore/tool/early_interrupt.h"

namespace lacuna {
namespace {

// The one variable that a signal handler can reach.
std::atomic<bool> interruptRequested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not take a lock");

std::atomic<bool> workBegun{false}, silent{false};

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

extern "C" void lacunaOnInterrupt(int) {
    if (!workBegun) {
        constexpr std::string_view kText = "interrupted: nothing is written\n";
        if (!silent) {
            const auto ignored = ::write(STDERR_FILENO, kText.data(), kText.size());
            (void)ignored;
        }
        _exit(kInterruptedExit);
    }
    if (interruptRequested.exchange(true)) _exit(kInterruptedExit);
}

/// Installs the handler. A SIGHUP that is ignored stays ignored (nohup). An ignored SIGINT does
/// not: scripts start background processes in this way.
void handle(int number) {
    struct sigaction action {};
    if (number == SIGHUP && sigaction(SIGHUP, nullptr, &action) == 0 &&
        action.sa_handler == SIG_IGN) {
        return;
    }
    action = {};
    action.sa_handler = lacunaOnInterrupt;
    action.sa_flags = SA_RESTART;  // libraries need not handle EINTR
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, nullptr);
}

}  // namespace

void endAtInterrupts() {
    for (const int number : kSignals) handle(number);
}

void endSilentlyAtInterrupts() {
    silent = true;
}

InterruptGuard::InterruptGuard() {
    interruptRequested = false;
    workBegun = true;
    sigaction(SIGINT, nullptr, &oldInt_);
    sigaction(SIGTERM, nullptr, &oldTerm_);
    for (const int number : kSignals) handle(number);
}

InterruptGuard::~InterruptGuard() {
    sigaction(SIGINT, &oldInt_, nullptr);
    sigaction(SIGTERM, &oldTerm_, nullptr);
}

const std::atomic<bool>& InterruptGuard::requested() const {
    return interruptRequested;
}

}  // namespace lacuna

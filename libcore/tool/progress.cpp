#include "libcore/tool/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace lacuna {
namespace {

constexpr auto kTick = std::chrono::milliseconds(200);  // refreshes the line, checks for interrupts
constexpr auto kPlainEvery = std::chrono::seconds(10);  // lines without a terminal

std::string rateText(double perSecond) {
    const bool mega = perSecond >= 1e5;
    char text[48];
    std::snprintf(text, sizeof text, "%.1f %srays/s", perSecond * (mega ? 1e-6 : 1e-3),
                  mega ? "M" : "k");
    return text;
}

}  // namespace

std::string durationText(double seconds) {
    char text[48];
    const auto s = static_cast<long long>(std::clamp(seconds, 0.0, 1e12));
    if (s < 60) {
        std::snprintf(text, sizeof text, "%llds", s);
    } else if (s < 3600) {
        std::snprintf(text, sizeof text, "%lldm%02llds", s / 60, s % 60);
    } else {
        std::snprintf(text, sizeof text, "%lldh%02lldm", s / 3600, s / 60 % 60);
    }
    return text;
}

TerminalProgress::TerminalProgress(bool quiet, const std::atomic<bool>& interrupted,
                                   const char* onInterrupt)
    : quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) == 1),
      interrupted_(interrupted),
      onInterrupt_(onInterrupt),
      phaseStart_(Clock::now()),
      iterationEnd_(phaseStart_) {
    if (!quiet_) thread_ = std::thread([this] { run(); });
}

TerminalProgress::~TerminalProgress() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
    clearLine();
}

void TerminalProgress::mute() {
    const std::lock_guard lock(mutex_);
    quiet_ = mute_ = true;
}

void TerminalProgress::phase(const std::string& name, const char* atInterrupt) {
    const std::lock_guard lock(mutex_);
    sayInterrupt();
    phase_ = name;
    phaseAtInterrupt_ = atInterrupt;
    phaseStart_ = Clock::now();
}

void TerminalProgress::iterations(const Iterations& iterations) {
    const std::lock_guard lock(mutex_);
    iterations_ = iterations;
    iterationEnd_ = Clock::now();
}

void TerminalProgress::remark(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (quiet_) return;
    print(text);
}

void TerminalProgress::warning(const std::string& text) {
    const std::lock_guard lock(mutex_);
    std::string coloured = terminal_ ? "\x1b[33m" : "";
    coloured += text;
    coloured += terminal_ ? "\x1b[0m" : "";
    print(coloured);
}

void TerminalProgress::print(const std::string& text) {
    if (mute_) return;
    clearLine();
    std::fprintf(stderr, "%s\n", text.c_str());
}

void TerminalProgress::clearLine() {
    if (lineShown_) std::fputs("\r\x1b[K", stderr);
    lineShown_ = false;
}

std::string TerminalProgress::line() const {
    const auto since = [](Clock::time_point t) {
        return std::chrono::duration<double>(Clock::now() - t).count();
    };
    const Iterations& i = iterations_;
    if (phase_ != "rendering") return phase_ + "  " + durationText(since(phaseStart_));

    std::string text = phase_ + "  iteration " + std::to_string(i.done + 1);
    if (i.limit > 0) text.append("/").append(std::to_string(i.limit));
    const double now = i.seconds + since(iterationEnd_);
    text.append("  ").append(durationText(now));
    if (i.done == 0) return text;
    text.append("  ").append(rateText(double(i.rays) / std::max(i.seconds, 1e-9)));
    double left = -1.0;
    if (i.limit > 0) left = i.seconds / double(i.done) * double(i.limit) - now;
    if (i.timeLimit > 0.0) {
        left = i.limit > 0 ? std::min(left, i.timeLimit - now) : i.timeLimit - now;
    }
    if (i.limit > 0 || i.timeLimit > 0.0)
        text.append("  ").append(durationText(left)).append(" left");
    if (!i.accuracy.empty()) text.append("  ").append(i.accuracy);
    return text;
}

void TerminalProgress::sayInterrupt() {
    if (quiet_ || interruptSaid_ || !interrupted_) return;
    interruptSaid_ = true;
    print(phaseAtInterrupt_      ? phaseAtInterrupt_
          : iterations_.done > 0 ? "interrupted: saving what there is (again: exit at once)"
                                 : onInterrupt_);
}

void TerminalProgress::run() {
    std::unique_lock lock(mutex_);
    Clock::time_point nextPlain = Clock::now() + kPlainEvery;
    while (!wake_.wait_for(lock, kTick, [this] { return stop_; })) {
        sayInterrupt();
        if (phase_.empty() || mute_) continue;
        if (terminal_) {
            std::fprintf(stderr, "\r%s\x1b[K", line().c_str());
            std::fflush(stderr);
            lineShown_ = true;
        } else if (Clock::now() >= nextPlain) {
            print(line());
            nextPlain = Clock::now() + kPlainEvery;
        }
    }
}

}  // namespace lacuna

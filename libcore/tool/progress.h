// What happens right now, on stderr: one refreshed line on a terminal, else a line every 10
// seconds.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace lacuna {

/// What tools say at an interrupt that leave nothing behind then.
inline constexpr const char* kNothingWritten =
    "interrupted: ending, nothing will be written (again: exit at once)";

class Progress {
  public:
    /// `quiet`: prints nothing but warnings. A thread of its own watches the clock and
    /// `interrupted`, which must outlive the object. `onInterrupt` is said then; null: what a
    /// render does.
    Progress(bool quiet, const std::atomic<bool>& interrupted, const char* onInterrupt = nullptr);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Nothing at all is printed from now on: another process speaks.
    void mute();
    /// What is being done: "loading", "rendering", ...
    void phase(const std::string& name);

    struct Iterations {
        std::uint64_t done = 0;
        std::uint64_t limit = 0;  ///< 0: none
        std::uint64_t rays = 0;   ///< so far
        double seconds = 0.0;     ///< so far
        double timeLimit = 0.0;   ///< seconds; 0: none
        std::string accuracy;     ///< the error now and when it will be less; empty: not known
    };
    void iterations(const Iterations& iterations);

    /// A line of its own; nothing if quiet.
    void remark(const std::string& text);
    /// A line of its own, quiet or not, in yellow on a terminal: the picture may not be what was
    /// meant.
    void warning(const std::string& text);

  private:
    using Clock = std::chrono::steady_clock;

    void run();
    std::string line() const;
    void clearLine();
    void print(const std::string& text);
    void sayInterrupt();

    bool quiet_;
    bool mute_ = false;
    const bool terminal_;
    const std::atomic<bool>& interrupted_;
    const char* const onInterrupt_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    bool stop_ = false;
    bool lineShown_ = false;
    bool interruptSaid_ = false;
    std::string phase_;
    Clock::time_point phaseStart_, iterationEnd_;
    Iterations iterations_;
    std::thread thread_;
};

/// "42s", "1m05s", "2h03m".
std::string durationText(double seconds);

}  // namespace lacuna

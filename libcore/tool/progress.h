// Reports of a tool's progress to a person at a terminal or to a program that uses the library.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "libcore/image/image.h"

namespace lacuna {

// Messages at an interrupt.
inline constexpr const char* kNothingWritten =
    "interrupted: ending, nothing will be written (again: exit at once)";
inline constexpr const char* kBeingSaved =
    "the picture is finished and is being saved (interrupted again: exit at once)";
inline constexpr const char* kFirstIteration =
    "interrupted: no iteration is complete yet; the first one has 3 s to end, or what there is "
    "of it is saved (again: exit at once)";

class Progress {
  public:
    virtual ~Progress() = default;

    /// A phase begins: "loading", "rendering", .. `atInterrupt` is the message if an interrupt
    /// comes during it; null: the listener's own message.
    virtual void phase(const std::string& name, const char* atInterrupt = nullptr) = 0;

    struct Iterations {
        std::uint64_t done = 0;
        std::uint64_t limit = 0;  ///< 0: none
        std::uint64_t rays = 0;   ///< so far
        double seconds = 0.0;     ///< so far
        double timeLimit = 0.0;   ///< seconds; 0: none
        std::string accuracy;     ///< current error and time until it is reached; empty: unknown
    };
    virtual void iterations(const Iterations& iterations) = 0;
    /// Called between iterations. `picture` makes the current picture if the listener calls it.
    virtual void picture(const std::function<Image()>& picture) { (void)picture; }

    /// Information for the user.
    virtual void remark(const std::string& text) = 0;
    /// The picture may not be what was meant.
    virtual void warning(const std::string& text) = 0;
};

/// Reports on stderr: one refreshed line on a terminal, else a line every 10 seconds.
class TerminalProgress final : public Progress {
  public:
    /// `quiet`: prints only warnings. A thread watches the clock and `interrupted`, which must
    /// outlive the object. `onInterrupt`: message at an interrupt before an iteration is done.
    TerminalProgress(bool quiet, const std::atomic<bool>& interrupted,
                     const char* onInterrupt = kFirstIteration);
    ~TerminalProgress() override;
    TerminalProgress(const TerminalProgress&) = delete;
    TerminalProgress& operator=(const TerminalProgress&) = delete;

    /// Prints nothing from now on: another process prints the messages.
    void mute();
    void phase(const std::string& name, const char* atInterrupt = nullptr) override;
    void iterations(const Iterations& iterations) override;
    /// Prints a separate line; nothing if quiet.
    void remark(const std::string& text) override;
    /// Prints a separate line, quiet or not, in yellow on a terminal.
    void warning(const std::string& text) override;

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
    const char* phaseAtInterrupt_ = nullptr;
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

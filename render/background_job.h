// Something that is done beside the render every so often, one at a time.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <string>

namespace lacuna {

class BackgroundJob {
  public:
    /// `seconds` between two begins, at least.
    explicit BackgroundJob(double seconds);
    /// Waits for what is being done.
    ~BackgroundJob();
    BackgroundJob(const BackgroundJob&) = delete;
    BackgroundJob& operator=(const BackgroundJob&) = delete;

    /// Whether it is time, and the last one is done.
    bool due() const;
    /// In the background. `due` or never begun.
    void begin(std::function<void()> work);
    void wait();
    /// Why the last one failed. Told once, and not again until one succeeds: a disk that is full
    /// stays full.
    std::optional<std::string> failure();

  private:
    using Clock = std::chrono::steady_clock;
    bool idle() const;

    std::chrono::duration<double> every_;
    Clock::time_point last_ = Clock::now();
    std::future<void> doing_;
    bool told_ = false;  ///< that the one before failed
};

}  // namespace lacuna

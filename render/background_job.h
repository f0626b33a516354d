// A recurring job in the background of the render, one at a time.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <string>

namespace lacuna {

class BackgroundJob {
  public:
    /// `seconds`: least time between two starts.
    explicit BackgroundJob(double seconds);
    /// Waits for the running job.
    ~BackgroundJob();
    BackgroundJob(const BackgroundJob&) = delete;
    BackgroundJob& operator=(const BackgroundJob&) = delete;

    /// Whether it is time for the next job and the last one is done.
    bool due() const;
    /// Starts `work` in the background. Requires that no job is running.
    void begin(std::function<void()> work);
    void wait();
    /// Why the last job failed. Reported once, and not again until a job has succeeded: a full disk
    /// stays full.
    std::optional<std::string> failure();

  private:
    using Clock = std::chrono::steady_clock;
    bool idle() const;

    std::chrono::duration<double> every_;
    Clock::time_point last_ = Clock::now();
    std::future<void> doing_;
    bool told_ = false;  ///< a failure has been reported
};

}  // namespace lacuna

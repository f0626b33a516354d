// Limits the time of the first iteration after an interrupt.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace lacuna {

class Grace {
  public:
    /// Sets `over` once `interrupted` has been true for `time`. Both must outlive the object.
    Grace(const std::atomic<bool>& interrupted, std::atomic<bool>& over,
          std::chrono::milliseconds time);
    ~Grace();
    Grace(const Grace&) = delete;
    Grace& operator=(const Grace&) = delete;

  private:
    void watch();

    const std::atomic<bool>& interrupted_;
    std::atomic<bool>& over_;
    const std::chrono::milliseconds time_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace lacuna

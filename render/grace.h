// Limits the time of the feature layers, and of the first iteration, after an interrupt.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace lacuna {

class Grace {
  public:
    /// Sets `over` once `interrupted` has been true for three seconds. Both must outlive the object.
    Grace(const std::atomic<bool>& interrupted, std::atomic<bool>& over);
    ~Grace();
    Grace(const Grace&) = delete;
    Grace& operator=(const Grace&) = delete;

  private:
    void watch();

    const std::atomic<bool>& interrupted_;
    std::atomic<bool>& over_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace lacuna

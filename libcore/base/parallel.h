// Parallel loops over oneTBB. Every loop here writes only to memory that belongs to one index
// alone, so that results never depend on the number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace lacuna {

/// The cancel flag of work that must be finished.
inline const std::atomic<bool> kNeverCancelled{false};

/// The worker threads of one tool run. `threads` = 0 means one for each processor that the process
/// may run on. The limit is 64 threads, or four per processor if that is more. Every worker keeps
/// the floating point environment of the constructing thread. (Otherwise Embree would leave
/// flush-to-zero set in some workers, and denormals would depend on the order of calls.)
class ThreadPool {
  public:
    /// Throws RunError if the system cannot start that many threads. The message begins with `title`,
    /// the user's name for their number ("--threads").
    explicit ThreadPool(int threads = 0, const std::string& title = "threads");
    ~ThreadPool();
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    int threads() const;
    /// Calls body(i) for i in [0, n), in any order, on all threads; returns when all are done.
    /// Exceptions of the body are rethrown here.
    void forEach(std::size_t n, const std::function<void(std::size_t)>& body) const;
    /// Runs `body` inside the pool's arena, so that TBB algorithms of libraries use its threads.
    void run(const std::function<void()>& body) const;
    /// Index of the calling worker in [0, threads()): for scratch memory, never for results.
    int workerIndex() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lacuna

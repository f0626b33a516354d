#include "libcore/base/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <sched.h>

#include <algorithm>
#include <exception>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "libcore/base/error.h"
#include "libcore/base/tbb_loop.h"

namespace lacuna {

namespace {
/// The number of processors that this process may run on: mpirun, taskset and containers can
/// restrict it to some of them.
int processors() {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
    return std::max(1, int(std::thread::hardware_concurrency()));
}

/// Limits the number of threads. More threads only wait for each other: 4096 threads on two
/// processors take 50 times as long as two.
int sensible(int threads) {
    constexpr int kAlways = 64, kPerProcessor = 4;
    const int available = processors();
    if (threads <= 0) return available;
    return std::min(threads, std::max(kAlways, kPerProcessor * available));
}

/// Throws RunError if the system cannot start `count` threads. oneTBB would throw where nobody can
/// catch it, so that the check comes before.
void requireRoomForThreads(int count, const std::string& title) {
    std::promise<void> allStarted;
    const std::shared_future<void> wait = allStarted.get_future().share();
    std::vector<std::thread> probes;
    probes.reserve(std::size_t(count));
    bool room = true;
    try {
        for (int i = 1; i < count; ++i) probes.emplace_back([wait] { wait.wait(); });
    } catch (const std::exception&) {  // no thread or no memory left
        room = false;
    }
    const std::size_t started = probes.size() + 1;
    allStarted.set_value();
    for (std::thread& probe : probes) probe.join();
    if (room) return;
    throw RunError(title + ": expected to start " + std::to_string(count) +
                   " threads, found room for " + std::to_string(started) +
                   "; use fewer, or raise the limits of processes or memory (ulimit)");
}

int checked(int threads, const std::string& title) {
    const int count = sensible(threads);
    requireRoomForThreads(count, title);
    return count;
}
}  // namespace

struct ThreadPool::Impl {
    explicit Impl(int threads)
        : limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads)),
          arena(threads) {}
    tbb::global_control limit;
    tbb::task_arena arena;
};

ThreadPool::ThreadPool(int threads, const std::string& title)
    : impl_(std::make_unique<Impl>(checked(threads, title))) {}
ThreadPool::~ThreadPool() = default;

int ThreadPool::threads() const {
    return impl_->arena.max_concurrency();
}

void ThreadPool::forEach(std::size_t n, const std::function<void(std::size_t)>& body) const {
    tbb::task_group_context context(
        tbb::task_group_context::bound,
        tbb::task_group_context::default_traits | tbb::task_group_context::fp_settings);
    context.capture_fp_settings();
    impl_->arena.execute([&] { tbbLoop(n, body, tbb::simple_partitioner{}, context); });
}

void ThreadPool::run(const std::function<void()>& body) const {
    impl_->arena.execute(body);
}

int ThreadPool::workerIndex() const {
    return std::max(0, tbb::this_task_arena::current_thread_index());
}

}  // namespace lacuna

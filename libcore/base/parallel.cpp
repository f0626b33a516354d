#include "libcore/base/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <sched.h>

#include <algorithm>
#include <thread>

namespace lacuna {

namespace {
/// Those that this process may run on: mpirun, taskset and containers leave it some of them.
int processors() {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
    return std::max(1, int(std::thread::hardware_concurrency()));
}

int resolved(int threads) {
    return threads > 0 ? threads : processors();
}
}  // namespace

struct ThreadPool::Impl {
    explicit Impl(int threads)
        : limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads)),
          arena(threads) {}
    tbb::global_control limit;
    tbb::task_arena arena;
};

ThreadPool::ThreadPool(int threads) : impl_(std::make_unique<Impl>(resolved(threads))) {}
ThreadPool::~ThreadPool() = default;

int ThreadPool::threads() const {
    return impl_->arena.max_concurrency();
}

void ThreadPool::forEach(std::size_t n, const std::function<void(std::size_t)>& body) const {
    tbb::task_group_context context(
        tbb::task_group_context::bound,
        tbb::task_group_context::default_traits | tbb::task_group_context::fp_settings);
    context.capture_fp_settings();
    impl_->arena.execute(
        [&] { tbb::parallel_for(std::size_t(0), n, body, tbb::simple_partitioner{}, context); });
}

void ThreadPool::run(const std::function<void()>& body) const {
    impl_->arena.execute(body);
}

int ThreadPool::workerIndex() const {
    return std::max(0, tbb::this_task_arena::current_thread_index());
}

}  // namespace lacuna

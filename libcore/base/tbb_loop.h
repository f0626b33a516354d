// A parallel loop in the caller's arena of oneTBB, as ThreadSanitizer can follow it.
#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <utility>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace lacuna {

/// Tells ThreadSanitizer that whatever was done before give() is seen after take(). oneTBB sees to that, but its
/// library is not compiled with the sanitizer.
class HandOver {
  public:
#ifdef __SANITIZE_THREAD__
    void give() {
        __tsan_release(this);
    }
    void take() {
        __tsan_acquire(this);
    }
#else
    void give() {}
    void take() {}
#endif
};

/// Calls body(i) for i in [0, n), by tbb::parallel_for with what else it takes: a partitioner, a context.
template <class Index, class Body, class... How>
void tbbLoop(Index n, const Body& body, How&&... how) {
    HandOver begun, done;
    const auto task = [&](Index i) {
        begun.take();
        body(i);
        done.give();
    };
    begun.give();
    tbb::parallel_for(Index(0), n, task, std::forward<How>(how)...);
    done.take();
}

}  // namespace lacuna

// A parallel loop in the caller's oneTBB arena that ThreadSanitizer can follow.
#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <utility>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace lacuna {

/// Tells ThreadSanitizer that everything done before give() is visible after take(). oneTBB ensures that, but its
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

/// Calls body(i) for i in [0, n) with tbb::parallel_for. `how`: its further arguments, such as a partitioner or a
/// context.
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

#include "libcore/base/parallel.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace lacuna::test {
namespace {

TEST(ThreadPool, EveryIndexOnce) {
    for (const int threads : {1, 2, 7}) {
        const ThreadPool pool(threads);
        EXPECT_EQ(pool.threads(), threads);
        for (const std::size_t n : {0ul, 1ul, 2ul, 1000ul}) {
            std::vector<std::atomic<int>> calls(n);
            std::atomic<bool> workersInRange = true;
            pool.forEach(n, [&](std::size_t i) {
                ++calls[i];
                const int worker = pool.workerIndex();
                if (worker < 0 || worker >= threads) workersInRange = false;
            });
            for (const auto& c : calls) ASSERT_EQ(c, 1);
            EXPECT_TRUE(workersInRange);
        }
    }
    EXPECT_GE(ThreadPool().threads(), 1);
}

TEST(ThreadPool, WorkersDoNotShareAnIndex) {
    const ThreadPool pool(4);
    std::vector<std::atomic<int>> inside(4);
    std::atomic<bool> shared = false;
    pool.forEach(200, [&](std::size_t) {
        std::atomic<int>& mine = inside[std::size_t(pool.workerIndex())];
        if (++mine != 1) shared = true;
        std::this_thread::yield();
        --mine;
    });
    EXPECT_FALSE(shared);
}

TEST(ThreadPool, ExceptionsComeThrough) {
    const ThreadPool pool(3);
    const auto boom = [](std::size_t i) {
        if (i == 137) throw std::runtime_error("index 137");
    };
    try {
        pool.forEach(1000, boom);
        FAIL();
    } catch (const std::runtime_error& e) {
        EXPECT_STREQ(e.what(), "index 137");
    }
    EXPECT_THROW(pool.run([] { throw std::logic_error("run"); }), std::logic_error);
    // The pool still works.
    std::atomic<int> sum = 0;
    pool.forEach(1000, [&](std::size_t i) { sum += int(i); });
    EXPECT_EQ(sum, 499'500);
}

TEST(ThreadPool, NestedLoops) {
    const ThreadPool pool(2);
    std::atomic<int> calls = 0;
    pool.forEach(8, [&](std::size_t) { pool.forEach(8, [&](std::size_t) { ++calls; }); });
    EXPECT_EQ(calls, 64);
}

TEST(ThreadPool, WorkersHaveTheCallersFloatingPointEnvironment) {
    const ThreadPool pool(4);
    const unsigned before = _mm_getcsr();
    for (const unsigned flags : {0x8040u, 0u}) {  // FTZ | DAZ, then neither
        _mm_setcsr((before & ~0x8040u) | flags);
        std::atomic<int> different = 0;
        pool.forEach(200, [&](std::size_t) { different += (_mm_getcsr() & 0x8040u) != flags; });
        _mm_setcsr(before);
        EXPECT_EQ(different, 0) << flags;
    }
}

}  // namespace
}  // namespace lacuna::test

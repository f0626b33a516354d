// addSplats, and the floating-point environment of our threads after Embree.
#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <atomic>
#include <cstring>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/bidir/film.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

std::vector<std::vector<Splat>> someSplats(std::size_t pixels) {
    std::vector<std::vector<Splat>> chunks(37);
    for (std::size_t c = 0; c < chunks.size(); ++c) {
        Rng rng(1, 0, StreamKind::User, c);
        for (std::size_t n = c == 5 ? 0 : 2000; n > 0; --n) {
            // Values span many decades, so that sums depend on their order.
            const float e = std::exp2(40 * rng.uniform() - 20);
            chunks[c].push_back({rng.below(std::uint32_t(pixels)), {e, e * rng.uniform(), 1}});
        }
    }
    return chunks;
}

TEST(AddSplats, SameBitsForAnyNumberOfThreads) {
    for (const std::size_t pixels : {1ul, 5ul, 1000ul}) {
        const auto chunks = someSplats(pixels);
        std::vector<Rgb> expected(pixels, Rgb(0.25f));
        for (const auto& chunk : chunks) {
            for (const Splat& s : chunk) expected[s.pixel] += s.value;
        }
        for (const int threads : {1, 2, 7}) {
            std::vector<Rgb> image(pixels, Rgb(0.25f));
            EXPECT_EQ(addSplats(chunks, image, ThreadPool(threads)), 0u);
            EXPECT_EQ(std::memcmp(image.data(), expected.data(), pixels * sizeof(Rgb)), 0)
                << pixels << " pixels, " << threads << " threads";
        }
    }
}

/// Three splats are finite, but their sum is not: the last one is left out and counted.
TEST(AddSplats, SumsStayFinite) {
    std::vector<std::vector<Splat>> chunks(2);
    for (const float value : {2e38f, 1e38f}) chunks[0].push_back({1, {value, 0, 1}});
    chunks[1].push_back({1, {3e38f, 0, 5}});
    chunks[1].push_back({0, Rgb(1.0f)});
    for (const int threads : {1, 2, 7}) {
        std::vector<Rgb> image(2);
        EXPECT_EQ(addSplats(chunks, image, ThreadPool(threads)), 1u) << threads;
        EXPECT_EQ(image[0], Rgb(1.0f));
        EXPECT_EQ(image[1], Rgb(2e38f + 1e38f, 0, 2)) << threads;
    }
}

TEST(ThreadPoolAndEmbree, NoFlushToZeroAfterACommit) {
    const ThreadPool workers(4);  // its threads start inside Embree's commit
    SceneBuilder b;
    for (int i = 0; i < 40; ++i) b.add(box({0, 0, 0}, {1, 1, 1}), translation({2.0 * i, 0, 0}));
    const Scene scene(b.d, workers);
    EXPECT_EQ(_mm_getcsr() & 0x8040u, 0u);
    volatile float tiny = 1e-39f;
    std::atomic<int> set = 0, flushed = 0;
    workers.forEach(1000, [&](std::size_t) {
        set += (_mm_getcsr() & 0x8040u) != 0;
        flushed += tiny * 0.5f == 0.0f;
    });
    EXPECT_EQ(set, 0);
    EXPECT_EQ(flushed, 0);
    workers.run([&] { set += (_mm_getcsr() & 0x8040u) != 0; });
    EXPECT_EQ(set, 0);
}

}  // namespace
}  // namespace lacuna::test

// Memory in large pages: whole, aligned for its type and, where it is large, for a page.
#include "libcore/base/large_pages.h"

#include <cstdint>
#include <new>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace lacuna {
namespace {

struct alignas(32) Wide {
    std::uint64_t value;
};

template <class T>
bool isAligned(const T* p, std::size_t to) {
    return reinterpret_cast<std::uintptr_t>(p) % to == 0;
}

TEST(LargePages, ContentsSurviveGrowthFromSmallToLarge) {
    constexpr std::size_t kPage = std::size_t(1) << 21;
    std::vector<std::uint64_t, LargePages<std::uint64_t>> numbers;
    for (std::uint64_t i = 0; i < kPage / 2; ++i) numbers.push_back(i);
    EXPECT_TRUE(isAligned(numbers.data(), kPage));
    for (std::uint64_t i = 0; i < numbers.size(); ++i) ASSERT_EQ(numbers[i], i);
}

TEST(LargePages, SmallArraysHaveTheAlignmentOfTheirType) {
    std::vector<Wide, LargePages<Wide>> wide(3);
    EXPECT_TRUE(isAligned(wide.data(), alignof(Wide)));
}

TEST(LargePages, SizesBeyondTheAddressesAreRefused) {
    LargePages<Wide> pages;
    EXPECT_THROW(pages.allocate(SIZE_MAX / sizeof(Wide) + 1), std::bad_alloc);
}

}  // namespace
}  // namespace lacuna

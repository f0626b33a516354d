// How the weights count picks that share their eye subpath.
#include <gtest/gtest.h>

#include "libcore/resampling/picks.h"

namespace lacuna::test {
namespace {

TEST(EyeShare, oneSampleStaysOneAndNoNumberCountsAsMoreThanTheInverse) {
    for (const double share : {0.0, 0.125, 0.25, 1.0}) {
        EXPECT_DOUBLE_EQ(withEyeShare(1.0, 3, share), 1.0) << share;
        EXPECT_EQ(withEyeShare(0.0, 3, share), 0.0) << share;  // no sample stays none
        double before = 0.0;
        for (const double samples : {1e-6, 0.5, 2.0, 40.0, 1e3, 1e9}) {
            const double counted = withEyeShare(samples, 5, share);
            EXPECT_GE(counted, before) << share << ' ' << samples;
            EXPECT_LE(counted * share, 1.0 + 1e-12) << share << ' ' << samples;
            before = counted;
        }
    }
    EXPECT_NEAR(withEyeShare(1e9, 3, 0.25), 4.0, 1e-6);
    // Var = share + (1 - share) / r at r = 4: 1/4 + 3/16.
    EXPECT_DOUBLE_EQ(withEyeShare(4.0, 3, 0.25), 16.0 / 7.0);
}

TEST(EyeShare, thePixelDeterminesTheFirstVertex) {
    EXPECT_EQ(withEyeShare(1e3, 1, 0.25), 1e3);
    EXPECT_EQ(withEyeShare(1e3, 7, 0.0), 1e3);
}

}  // namespace
}  // namespace lacuna::test

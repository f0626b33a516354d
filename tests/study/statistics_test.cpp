// Values that are read off curves, and summaries of runs.
#include <gtest/gtest.h>

#include <cmath>

#include "render/study/band.h"
#include "render/study/spread.h"

namespace lacuna {
namespace {

using Values = std::vector<std::optional<double>>;

/// error = scale * seconds^-0.5 at these times, one iteration each, setup of 3 s.
Curve halfSlope(const std::vector<double>& times, double scale = 1.0) {
    Curve curve;
    for (const double t : times) {
        const double e = scale / std::sqrt(t);
        curve.points.push_back({double(curve.points.size() + 1), t, 3.0, {e, e, e, e * e}});
    }
    return curve;
}

TEST(StudySpread, MedianAndRange) {
    const Spread odd = spread(Values{3.0, 1.0, 2.0});
    EXPECT_EQ(odd.median, 2.0);
    EXPECT_EQ(odd.low, 1.0);
    EXPECT_EQ(odd.high, 3.0);
    EXPECT_EQ(spread(Values{4.0, 1.0, 2.0, 3.0}).median, 2.5);
    EXPECT_EQ(spreadText(odd), "2 (1 to 3)");
    EXPECT_EQ(spreadText(spread(Values{0.12345})), "0.123");
}

TEST(StudySpread, WhatWasNotReachedIsBeyondEverything) {
    const Spread most = spread(Values{std::nullopt, 1.0, 2.0});
    EXPECT_EQ(most.median, 2.0);
    EXPECT_EQ(most.high, std::nullopt);
    EXPECT_EQ(spreadText(most), "2 (1 to not reached)");
    EXPECT_EQ(spreadText(spread(Values{std::nullopt, 1.0, std::nullopt})),
              "not reached (1 of 3 seeds)");
    // Two of four: the median lies between a value and none.
    EXPECT_EQ(spread(Values{std::nullopt, 1.0, 1.0, std::nullopt}).median, std::nullopt);
    EXPECT_EQ(spreadText(spread(Values{std::nullopt, std::nullopt})), "not reached");
}

TEST(StudySpread, RatiosArePairedBySeed) {
    const Values times = ratios(Values{2.0, 30.0, 4.0}, Values{1.0, 10.0, std::nullopt});
    EXPECT_EQ(times, (Values{2.0, 3.0, std::nullopt}));
}

TEST(StudyCurve, ReadsOnTheLineInLogLogAndNowhereElse) {
    const Curve curve = halfSlope({1.0, 100.0});
    EXPECT_NEAR(*errorAt(curve.points, Measure::Mape, 25.0, Axis::Seconds), 0.2, 1e-12);
    EXPECT_NEAR(*errorAt(curve.points, Measure::Mape, 100.0, Axis::Seconds), 0.1, 1e-12);
    EXPECT_EQ(errorAt(curve.points, Measure::Mape, 0.99, Axis::Seconds), std::nullopt);
    EXPECT_EQ(errorAt(curve.points, Measure::Mape, 100.01, Axis::Seconds), std::nullopt);
    EXPECT_NEAR(*errorAt(curve.points, Measure::Mape, 2.0, Axis::Iterations), 0.1, 1e-12);

    EXPECT_NEAR(*timeToError(curve.points, Measure::Mape, 0.2, Axis::Seconds), 25.0, 1e-9);
    EXPECT_EQ(timeToError(curve.points, Measure::Mape, 0.0999, Axis::Seconds), std::nullopt);
    // The error is below the bound from the first row on, whose time counts.
    EXPECT_EQ(timeToError(curve.points, Measure::Mape, 2.0, Axis::Seconds), 1.0);
    EXPECT_EQ(timeToError(curve.points, Measure::Mape, 2.0, Axis::SecondsWithSetup), 4.0);
}

TEST(StudyCurve, AnErrorThatRisesAgainCountsFromTheLastTime) {
    Curve curve = halfSlope({1.0, 4.0, 16.0, 64.0});
    curve.points[2].errors[0] = 3.0;  // an outlier came in
    const double t = *timeToError(curve.points, Measure::Mae, 0.6, Axis::Seconds);
    EXPECT_GT(t, 16.0);
    EXPECT_LT(t, 64.0);
}

TEST(StudyBand, CoversWhatAllSeedsHave) {
    const Curve a = halfSlope({1.0, 10.0, 100.0}), b = halfSlope({2.0, 20.0, 80.0}, 2.0),
                c = halfSlope({1.5, 15.0, 90.0}, 3.0);
    const Curve* curves[] = {&a, &b, &c};
    const std::vector<BandPoint> points = band(curves, Measure::Mape, Axis::Seconds);
    ASSERT_GE(points.size(), 16u);
    EXPECT_EQ(points.front().x, 2.0);
    EXPECT_EQ(points.back().x, 80.0);
    for (const BandPoint& p : points) {
        EXPECT_NEAR(p.low * std::sqrt(p.x), 1.0, 1e-9);
        EXPECT_NEAR(p.median * std::sqrt(p.x), 2.0, 1e-9);
        EXPECT_NEAR(p.high * std::sqrt(p.x), 3.0, 1e-9);
    }
    EXPECT_EQ(commonEnd(curves, Axis::SecondsWithSetup), 83.0);
}

TEST(StudyBand, IsOnePointWhereRunsDoNotOverlap) {
    const Curve a = halfSlope({1.0}), b = halfSlope({2.0}), c = halfSlope({3.0});
    const Curve* curves[] = {&a, &b, &c};
    const std::vector<BandPoint> points = band(curves, Measure::Mape, Axis::Seconds);
    ASSERT_EQ(points.size(), 1u);
    EXPECT_EQ(points[0].x, 2.0);
    EXPECT_NEAR(points[0].median, 1.0 / std::sqrt(2.0), 1e-12);
    EXPECT_TRUE(band({}, Measure::Mape, Axis::Seconds).empty());
}

}  // namespace
}  // namespace lacuna

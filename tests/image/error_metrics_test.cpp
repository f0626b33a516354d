#include "libcore/image/error_metrics.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "libcore/image/error_map.h"
#include "tests/image/test_files.h"

namespace lacuna {
namespace {

using test::messageOf;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(ErrorMetrics, ByHand) {
    Image reference(2, 1), image(2, 1);
    reference.at(0, 0) = {1, 2, 3};
    reference.at(1, 0) = {0, 4, 2};  // mean 2, e = 0.02
    image.at(0, 0) = {2, 2, 1};      // differences 1, 0, -2
    image.at(1, 0) = {0.5f, 4, 2};   // 0.5, 0, 0
    const ErrorReference r(reference);
    EXPECT_DOUBLE_EQ(r.epsilon(), 0.02);
    const ErrorMeasures m = r.compare(image);
    EXPECT_EQ(m.pixels, 2u);
    EXPECT_DOUBLE_EQ(m.mae, 3.5 / 6);
    EXPECT_DOUBLE_EQ(m.rmse, std::sqrt(5.25 / 6));
    EXPECT_DOUBLE_EQ(m.mape, (1 / 1.02 + 2 / 3.02 + 0.5 / 0.02) / 6);
    EXPECT_DOUBLE_EQ(m.relmse, (1 / 1.0004 + 4 / 9.0004 + 0.25 / 0.0004) / 6);
    EXPECT_DOUBLE_EQ(r.relativeError(image, 0, 0), (1 / 1.02 + 2 / 3.02) / 3);
}

TEST(ErrorMetrics, EqualImagesAndScale) {
    const Image a = test::randomImage(13, 7, 1), b = test::randomImage(13, 7, 2);
    const ErrorMeasures zero = ErrorReference(a).compare(a);
    EXPECT_EQ(zero.mae + zero.rmse + zero.mape + zero.relmse, 0.0);
    // Powers of two scale exactly: mae and rmse with the radiance, the relative ones not at all.
    Image a4 = a, b4 = b;
    for (Rgb& p : a4.pixels) p *= 4.0f;
    for (Rgb& p : b4.pixels) p *= 4.0f;
    const ErrorMeasures m = ErrorReference(a).compare(b), m4 = ErrorReference(a4).compare(b4);
    EXPECT_EQ(m4.mae, 4 * m.mae);
    EXPECT_EQ(m4.rmse, 4 * m.rmse);
    EXPECT_DOUBLE_EQ(m4.mape, m.mape);
    EXPECT_DOUBLE_EQ(m4.relmse, m.relmse);
}

TEST(ErrorMetrics, SumsInDouble) {
    // 10^6 pixels that differ by 1 beside one that differs by 10^8: float would lose the ones.
    Image reference(1000, 1000, Rgb(1)), image(1000, 1000, Rgb(2));
    image.at(0, 0) = Rgb(1e8f);
    EXPECT_DOUBLE_EQ(ErrorReference(reference).compare(image).mae, (999999 + 1e8 - 1) / 1e6);
}

TEST(ErrorMetrics, BlackReference) {
    const ErrorReference black(Image(4, 3));
    const ErrorMeasures same = black.compare(Image(4, 3));
    EXPECT_EQ(same.mape, 0.0);
    EXPECT_EQ(same.relmse, 0.0);
    Image image(4, 3);
    image.at(2, 2) = {0, 1e-30f, 0};
    const ErrorMeasures m = black.compare(image);
    EXPECT_EQ(m.mape, kInf);
    EXPECT_EQ(m.relmse, kInf);
    EXPECT_DOUBLE_EQ(m.mae, double(1e-30f) / 36);
    image.at(2, 2) = {0, -1e-30f, 0};
    EXPECT_EQ(black.compare(image).mape, kInf);
    EXPECT_EQ(black.relativeError(image, 2, 2), kInf);
    EXPECT_EQ(black.relativeError(image, 0, 0), 0.0);
}

TEST(ErrorMetrics, RefusesAndSaysWhere) {
    Image bad(4, 3, Rgb(1));
    bad.at(3, 1).g = kNan;
    const ErrorReference good(Image(4, 3, Rgb(1)), "ref.exr");
    for (const std::string& message :
         {messageOf<InputError>([&] { good.compare(bad, "bad.exr"); }),
          messageOf<InputError>([&] { ErrorReference r(bad, "bad.exr"); })}) {
        EXPECT_NE(message.find("bad.exr: expected finite pixels, found nan in G of pixel (3, 1)"),
                  std::string::npos)
            << message;
    }
    bad.at(3, 1).g = -kInf;
    EXPECT_THROW(good.compare(bad), InputError);
    const std::string sizes = messageOf<InputError>([&] { good.compare(Image(3, 4), "a.exr"); });
    EXPECT_NE(sizes.find("a.exr: expected 4 x 3 pixels as in ref.exr, found 3 x 4"),
              std::string::npos)
        << sizes;
    EXPECT_THROW(ErrorReference{Image()}, InputError);
    Image negative(4, 3, Rgb(1));
    negative.at(1, 2).b = -0.001f;  // above -e: the formula holds
    EXPECT_NO_THROW(ErrorReference{negative});
    negative.at(1, 2).b = -0.5f;
    EXPECT_NE(messageOf<InputError>([&] { ErrorReference{negative}; }).find("B of pixel (1, 2)"),
              std::string::npos);
    EXPECT_THROW(ErrorReference(Image(4, 3, Rgb(-1))), InputError);
}

double luminance(const std::array<std::uint8_t, 3>& c) {
    const auto linear = [](double v) { return std::pow(v / 255, 2.2); };
    return 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
}

TEST(ErrorMap, LightnessGrowsWithTheError) {
    double last = -1;
    for (double e = kErrorMapLow; e <= kErrorMapHigh; e *= 1.08) {
        EXPECT_GT(luminance(errorColour(e)), last) << e;
        last = luminance(errorColour(e));
    }
    using Colour = std::array<std::uint8_t, 3>;
    EXPECT_EQ(errorColour(0), (Colour{0, 0, 0}));
    EXPECT_EQ(errorColour(kErrorMapLow), (Colour{0, 0, 0}));
    EXPECT_EQ(errorColour(0.1), (Colour{210, 55, 80}));
    EXPECT_EQ(errorColour(1e5), errorColour(kErrorMapHigh));
    EXPECT_EQ(errorColour(kInf), (Colour{255, 250, 190}));
}

TEST(ErrorMap, PixelsInPlace) {
    Image image(3, 2, Rgb(1));
    image.at(2, 1) = Rgb(1e6f);
    const ErrorReference reference(Image(3, 2, Rgb(1)));
    const auto bytes = errorMap(image, reference);
    ASSERT_EQ(bytes.size(), 18u);
    EXPECT_EQ(std::accumulate(bytes.begin(), bytes.begin() + 15, 0), 0);
    EXPECT_EQ(bytes[15], 255);
    EXPECT_THROW(errorMap(Image(2, 2), reference), InputError);
}

}  // namespace
}  // namespace lacuna

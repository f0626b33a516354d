#include "libcore/image/tone.h"

#include <limits>

#include "libcore/image/image_io.h"
#include "tests/image/test_files.h"

namespace lacuna {
namespace {

double grey(double v, Tone tone) {
    return toned(Rgb(float(v)), 1.0, tone)[0];
}

TEST(Tone, standardCutsOff) {
    EXPECT_EQ(grey(0.3, Tone::Standard), double(0.3f));
    EXPECT_EQ(grey(7.0, Tone::Standard), 1.0);
    EXPECT_EQ(toned(Rgb(0.25f), 2.0, Tone::Standard)[1], 0.5);
}

TEST(Tone, filmicKeepsMidGreyAndTellsHighlightsApart) {
    EXPECT_NEAR(grey(0.18, Tone::Filmic), 0.18, 1e-6);
    EXPECT_NEAR(grey(16.0, Tone::Filmic), 1.0, 1e-6);
    EXPECT_EQ(grey(1e30, Tone::Filmic), grey(16.0, Tone::Filmic));
    double before = 0.0;
    for (double v = 1e-4; v < 15.0; v *= 1.2) {
        const double shown = grey(v, Tone::Filmic);
        EXPECT_GT(shown, before) << v;
        before = shown;
    }
    // Highlights that Standard shows as one white are tens of 8-bit levels apart.
    const auto code = [](double v) { return 255.0 * linearToSrgb(grey(v, Tone::Filmic)); };
    EXPECT_GT(code(8.0) - code(1.0), 30.0);
}

TEST(Tone, brightColoursComeCloserToWhite) {
    const auto blue = toned(Rgb(0.0f, 0.0f, 10.0f), 1.0, Tone::Filmic);
    EXPECT_GT(blue[0], 0.005);
    EXPECT_LT(blue[0], 0.2);
    EXPECT_GT(blue[2], 0.9);
}

TEST(Tone, whatIsNoNumberIsBlackOrWhite) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    for (const Tone tone : {Tone::Standard, Tone::Filmic}) {
        const auto shown = toned(Rgb(-1.0f, nan, infinity), 1.0, tone);
        EXPECT_EQ(shown[0], 0.0);
        EXPECT_EQ(shown[1], 0.0);
        EXPECT_NEAR(shown[2], 1.0, 1e-6);
    }
}

TEST(Exposure, bringsWhatThereIsToMidGrey) {
    EXPECT_NEAR(automaticExposure(Image(50, 30, Rgb(0.18f))), 0.0, 1e-6);
    EXPECT_NEAR(automaticExposure(Image(50, 30, Rgb(0.18f * 1024.0f))), -10.0, 1e-6);
    EXPECT_NEAR(automaticExposure(Image(1, 1, Rgb(0.09f))), 1.0, 1e-6);
    EXPECT_EQ(automaticExposure(Image(50, 30)), 0.0);
}

TEST(Exposure, windowsDarknessAndDefectsHaveNoSay) {
    Image room(200, 100, Rgb(0.02f));
    const double plain = automaticExposure(room);
    for (int y = 20; y < 40; ++y) {
        for (int x = 30; x < 90; ++x) room.at(x, y) = Rgb(1000.0f);  // 6 % of the picture
    }
    EXPECT_NEAR(automaticExposure(room), plain, 0.01);
    room.at(5, 90) = Rgb(std::numeric_limits<float>::infinity());
    room.at(6, 95) = Rgb(std::numeric_limits<float>::quiet_NaN());
    EXPECT_NEAR(automaticExposure(room), plain, 0.01);
    for (int y = 0; y < 100; ++y) {
        for (int x = 100; x < 200; ++x) room.at(x, y) = Rgb(0);
    }
    EXPECT_NEAR(automaticExposure(room), plain, 0.6);
}

/// One pixel in twenty finds the light, and has twenty times as much.
TEST(Exposure, ofANoisyPictureIsThatOfACleanOne) {
    Image noisy(480, 270);
    std::mt19937 random(1);
    for (Rgb& p : noisy.pixels) p = random() % 20 == 0 ? Rgb(2.0f) : Rgb(0);
    EXPECT_NEAR(automaticExposure(noisy), automaticExposure(Image(480, 270, Rgb(0.1f))), 0.3);
}

TEST(Exposure, isAutoOrStops) {
    EXPECT_EQ(parseExposure("--exposure", "auto"), std::nullopt);
    EXPECT_EQ(parseExposure("--exposure", "-1.5"), -1.5);
    for (const char* text : {"", "inf", "nan", "1001", "automatic", "1 stop"}) {
        EXPECT_THROW(parseExposure("--exposure", text), UsageError) << text;
    }
    EXPECT_THROW(parseTone("--tone", "Filmic"), UsageError);
}

}  // namespace
}  // namespace lacuna

// Parts of lacuna-render, each tested alone.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "libcore/base/error.h"
#include "render/curve_log.h"
#include "render/options.h"

namespace lacuna {
namespace {

TEST(RenderUnits, Durations) {
    EXPECT_EQ(parseDuration("--time", "90s"), 90.0);
    EXPECT_EQ(parseDuration("--time", "90"), 90.0);
    EXPECT_EQ(parseDuration("--time", "0.5"), 0.5);
    EXPECT_EQ(parseDuration("--time", "1.5m"), 90.0);
    EXPECT_EQ(parseDuration("--time", "1h"), 3600.0);
    for (const char* text : {"", "s", "0", "0s", "-1s", "1 s", "1ms", "infs", "nans", "0x1s"}) {
        EXPECT_THROW(parseDuration("--time", text), UsageError) << text;
    }
}

TEST(RenderUnits, CropsAndReplays) {
    EXPECT_EQ(parseCrop("1,2,3,5"), (PixelRect{1, 2, 3, 5}));
    EXPECT_THROW(parseCrop("1,2,3"), UsageError);
    EXPECT_THROW(parseCrop("1,2,3,99999999999"), UsageError);
    const ReplayRequest eye = parseReplay("7,8,9");
    EXPECT_FALSE(eye.light);
    EXPECT_EQ(eye.x, 7);
    EXPECT_EQ(eye.y, 8);
    EXPECT_EQ(eye.iteration, 9u);
    const ReplayRequest light = parseReplay("light:12345678901,9");
    EXPECT_TRUE(light.light);
    EXPECT_EQ(light.path, 12345678901u);
    EXPECT_EQ(light.iteration, 9u);
}

TEST(RenderUnits, CurveLogWantsTenRowsPerDecade) {
    const std::string file = (std::filesystem::temp_directory_path() /
                              ("lacuna-curve-" + std::to_string(::getpid()) + ".csv"))
                                 .string();
    {
        CurveLog log(file);
        EXPECT_EQ(log.lastIteration(), 0u);
        int rows = 0;
        for (int i = 1; i <= 99999; ++i) {
            const double seconds = 1e-3 * i * 1.0000001;
            const bool wanted = log.wants(seconds);
            EXPECT_TRUE(wanted || i > 1);
            rows += wanted;
        }
        EXPECT_LE(rows, 50);
        EXPECT_GT(rows, 40);
        log.write({3, 0.5, 0.25, {1, 2, 0, 4}, std::nullopt, {}});
        ErrorMeasures e;
        e.mae = 0.1;
        e.relmse = std::numeric_limits<double>::infinity();
        log.write({4, 1.0, 0.25, {2, 7}, e, {{"eye paths", 0.5}, {"light paths", 0.25}}});
        EXPECT_EQ(log.lastIteration(), 4u);
    }
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    EXPECT_EQ(text,
              "iteration,seconds,setup_seconds,rays,mae,rmse,mape,relmse,rays_camera,rays_eye,"
              "rays_light,rays_connection,rays_splat,rays_cache,rays_chain,phases\n"
              "3,0.5,0.25,7,,,,,1,2,0,4,0,0,0,\n"
              "4,1,0.25,9,0.1,0,0,inf,2,7,0,0,0,0,0,eye paths=0.5;light paths=0.25\n");
    {
        // A reader with the file open still sees the old one, whole: the file is replaced, not
        // changed.
        std::ifstream before(file);
        CurveLog goesOn(file, 4);
        EXPECT_EQ(goesOn.lastIteration(), 4u);
        goesOn.write({5, 2.0, 0.25, {}, std::nullopt, {}});
        const std::string old{std::istreambuf_iterator<char>(before),
                              std::istreambuf_iterator<char>()};
        EXPECT_EQ(old, text);
        std::ifstream after(file);
        const std::string now{std::istreambuf_iterator<char>(after),
                              std::istreambuf_iterator<char>()};
        EXPECT_TRUE(now.starts_with(text + "5,2,")) << now;
    }
    std::filesystem::remove(file);
    EXPECT_THROW(CurveLog("/nonexistent/curve.csv"), RunError);
    CurveLog full("/dev/null");
    EXPECT_NO_THROW(full.write({1, 1.0, 1.0, {}, std::nullopt, {}}));
    if (std::filesystem::exists("/dev/full")) {
        EXPECT_THROW(CurveLog("/dev/full"), RunError);
    }
}

}  // namespace
}  // namespace lacuna

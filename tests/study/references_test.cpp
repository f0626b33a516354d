// The reference pictures of the studies show what this program renders, with the present scenes and
// on the machine that runs the test.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "libcore/image/exr.h"
#include "render/study/study_file.h"
#include "tests/fixtures/render_tool.h"
#include "tests/material/statistics.h"

namespace lacuna::test {
namespace {

constexpr double kFalseAlarm = 1e-4;  // for all rows, columns and channels of a picture together
constexpr int kIterations = 128;

class ShippedReferences : public RenderTool {};

/// Our scenes whose reference is a file, by that file. The options are those of the first study (by
/// name) that uses it; other studies only render the same picture in other ways.
std::map<std::string, StudyScene> shippedReferences() {
    setenv("LACUNA_SHARED_SCENES", "/nowhere", 0);
    std::set<std::string> studies;
    for (const auto& entry : std::filesystem::directory_iterator(LACUNA_STUDIES)) {
        if (entry.path().extension() == ".json") studies.insert(entry.path());
    }
    std::map<std::string, StudyScene> found;
    for (const std::string& study : studies) {
        for (const bool quick : {false, true}) {
            for (const StudyScene& scene : readStudy(study, quick).scenes) {
                if (!scene.reference.empty()) found.emplace(scene.reference, scene);
            }
        }
    }
    return found;
}

/// Largest deviation of a row's or a column's mean, in standard errors of both pictures.
double worstStrip(const LayeredImage& a, const LayeredImage& b, const std::string& channel) {
    const std::vector<float>&valueA = *a.find(channel), &valueB = *b.find(channel);
    const std::vector<float>&varianceA = *a.find("variance." + channel),
          &varianceB = *b.find("variance." + channel);
    const auto strip = [&](std::size_t begin, std::size_t step, std::size_t count) {
        double difference = 0.0, variance = 0.0;
        for (std::size_t i = begin; count > 0; i += step, --count) {
            difference += double(valueA[i]) - double(valueB[i]);
            variance += double(varianceA[i]) + double(varianceB[i]);
        }
        return std::abs(difference) / std::sqrt(variance);
    };
    const std::size_t width = std::size_t(a.width()), height = std::size_t(a.height());
    double worst = 0.0;
    for (std::size_t x = 0; x < width; ++x) worst = std::max(worst, strip(x, width, height));
    for (std::size_t y = 0; y < height; ++y) worst = std::max(worst, strip(y * width, 1, width));
    return worst;
}

TEST_F(ShippedReferences, ShowWhatIsRenderedHere) {
    const std::map<std::string, StudyScene> references = shippedReferences();
    ASSERT_FALSE(references.empty());
    for (const auto& [file, scene] : references) {
        SCOPED_TRACE(file);
        std::string arguments = scene.file + " --method bpt --seed 7 --quiet -o @here.exr";
        for (const std::string& option : scene.options) arguments += " " + option;
        const Outcome outcome = run(arguments + " --iterations " + std::to_string(kIterations));
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;

        const LayeredImage reference = readExrLayers(file), here = readExrLayers(path("here.exr"));
        ASSERT_EQ(std::tuple(reference.width(), reference.height()),
                  std::tuple(here.width(), here.height()));
        EXPECT_EQ(reference.attributes.at("sceneHash"), here.attributes.at("sceneHash"))
            << "the scene has changed: render the reference anew (tests/README.md)";

        const double strips = 3.0 * (here.width() + here.height());
        const double allowed = allowedErrors(kFalseAlarm, strips, kIterations - 1);
        for (const std::string channel : {"R", "G", "B"}) {
            const double worst = worstStrip(reference, here, channel);
            RecordProperty(channel + " worst standard errors", std::to_string(worst));
            EXPECT_LE(worst, allowed) << "standard errors of a row or column, channel " << channel;
        }
    }
}

}  // namespace
}  // namespace lacuna::test

// Compares scenes that other tools packed (tests/exporters/, made by make.py there) with their originals. What the
// camera sees first has no noise and must agree up to the tool's rounding. Pictures must agree within their noise.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libcore/image/exr.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

const std::string kFolder = LACUNA_SCENES "/../tests/exporters/";

/// An entry of files.json.
struct Exported {
    std::string name, twin;
    /// Allowed difference for most pixels: of albedo, of a normal's coordinate, of depth (relative).
    double albedo = 1e-3, normal = 1e-2, depth = 3e-4;
    /// Allowed relative difference of the pictures' means: other normals reflect other light.
    double mean = 0.0;
    std::vector<std::string> warnings = {};  ///< parts of the expected warnings
};
void PrintTo(const Exported& file, std::ostream* out) {
    *out << file.name;
}

std::vector<Exported> filesOfOthers() {
    std::ifstream in(kFolder + "files.json");
    std::vector<Exported> files;
    for (const nlohmann::json& f : nlohmann::json::parse(in)) {
        Exported file{f.at("name"), f.at("twin")};
        file.warnings = f.value("warnings", file.warnings);
        const nlohmann::json off = f.value("off_by", nlohmann::json::object());
        file.albedo = off.value("albedo", file.albedo);
        file.normal = off.value("normal", file.normal);
        file.depth = off.value("depth", file.depth);
        file.mean = off.value("mean", file.mean);
        files.push_back(file);
    }
    return files;
}

class FilesOfExporters : public RenderTool, public ::testing::WithParamInterface<Exported> {
  protected:
    LayeredImage rendered(const std::string& scene,
                          const std::vector<std::string>& warnings) const {
        const Outcome o = run(scene +
                              " -o @out.exr --method bpt --width 64 --iterations 32 "
                              "--max-depth 6 --quiet");
        EXPECT_EQ(o.exitCode, 0) << o.err;
        std::istringstream lines(o.err);
        for (std::string line; std::getline(lines, line);) {
            EXPECT_TRUE(std::ranges::any_of(warnings, [&](const std::string& part) {
                return line.find(part) != line.npos;
            })) << line;
        }
        return readExrLayers(path("out.exr"));
    }
};

/// The difference that all but a fiftieth of the pixels stay below. Edges of objects may move by a pixel.
double mostPixels(std::vector<double> differences) {
    const auto at = differences.begin() + std::ptrdiff_t(differences.size() * 49 / 50);
    std::nth_element(differences.begin(), at, differences.end());
    return *at;
}

double farthest(const LayeredImage& a, const LayeredImage& b,
                const std::vector<std::string>& channels, bool relative) {
    std::vector<double> differences(a.find(channels[0])->size());
    for (const std::string& channel : channels) {
        const std::vector<float>&one = *a.find(channel), &other = *b.find(channel);
        for (std::size_t i = 0; i < one.size(); ++i) {
            const double d = std::abs(double(one[i]) - double(other[i]));
            const double size = relative ? std::max(double(other[i]), 1e-9) : 1.0;
            differences[i] = std::max(differences[i], d / size);
        }
    }
    return mostPixels(std::move(differences));
}

TEST_P(FilesOfExporters, renderAsTheirTwins) {
    const Exported& file = GetParam();
    const LayeredImage packed = rendered(kFolder + file.name, file.warnings);
    const LayeredImage plain = rendered(LACUNA_SCENES "/" + file.twin, {});
    ASSERT_EQ(packed.width(), plain.width());
    ASSERT_EQ(packed.height(), plain.height());
    EXPECT_LE(farthest(packed, plain, {"albedo.R", "albedo.G", "albedo.B"}, false), file.albedo);
    EXPECT_LE(farthest(packed, plain, {"normal.X", "normal.Y", "normal.Z"}, false), file.normal);
    EXPECT_LE(farthest(packed, plain, {"Z"}, true), file.depth);

    // The pictures differ by at most their noise, often by less, because many paths are the same.
    double squares = 0.0, difference = 0.0, variances = 0.0, sum = 0.0;
    int count = 0;
    for (const std::string channel : {"R", "G", "B"}) {
        const std::vector<float>&a = *packed.find(channel), &b = *plain.find(channel);
        const std::vector<float>&ofA = *packed.find("variance." + channel),
              &ofB = *plain.find("variance." + channel);
        for (std::size_t i = 0; i < a.size(); ++i) {
            const double d = double(a[i]) - double(b[i]), v = double(ofA[i]) + double(ofB[i]);
            if (!(v > 0.0)) continue;
            squares += d * d / v;
            difference += d;
            variances += v;
            sum += double(b[i]);
            ++count;
        }
    }
    ASSERT_GT(count, 1000);
    EXPECT_LT(std::sqrt(squares / count), 1.2);
    EXPECT_LT(std::abs(difference), 4.0 * std::sqrt(variances) + file.mean * sum);
}

INSTANTIATE_TEST_SUITE_P(All, FilesOfExporters, ::testing::ValuesIn(filesOfOthers()),
                         [](const auto& test) {
                             std::string name = test.param.name;
                             std::erase_if(name, [](char c) { return c == '-'; });
                             return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace lacuna::test

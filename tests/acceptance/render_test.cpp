#include "tests/acceptance/render_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

#include "libcore/base/number_text.h"
#include "tests/acceptance/scene_caches.h"
#include "tests/fixtures/random_guide.h"
#include "tests/fixtures/random_walk_guide.h"

namespace lacuna::test {

namespace {

PixelRect cropOf(const Shot& shot) {
    return shot.crop == PixelRect{} ? PixelRect{0, shot.width, 0, shot.height} : shot.crop;
}

/// One thread unless the shot has others: films are small, and tests run side by side.
const ThreadPool& threadsOf(const Shot& shot) {
    static const ThreadPool one(1);
    return shot.threads ? *shot.threads : one;
}

Settings settingsOf(const MethodRow& row, const Shot& shot) {
    std::vector<std::string> assignments = shot.settings;
    for (const Option& p : row.options) {
        if (p.name == "candidates") {
            const int pool = shot.candidates ? shot.candidates : shot.width * shot.height;
            assignments.push_back("candidates=" + std::to_string(pool));
        }
        if (p.name == "radius") assignments.push_back("radius=" + numberText(shot.radius));
        if (p.name == "light_paths" && shot.lightPaths) {
            assignments.push_back("light_paths=" + std::to_string(shot.lightPaths));
        }
    }
    return resolve(row, assignments);
}

double threshold(double tests, std::uint64_t samples) {
    return allowedErrors(kFalseAlarm, tests, double(samples) - 1.0);
}

float channel(const Rgb& c, int i) {
    return i == 0 ? c.r : i == 1 ? c.g : c.b;
}

/// For worstDeviation(): the running test, and its largest share so far.
struct {
    const testing::TestInfo* test = nullptr;
    double share = 0;
} worstSoFar;

bool within(double deviation, double allowed) {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    if (worstSoFar.test != test) worstSoFar = {test, 0};
    if (deviation > 0) worstSoFar.share = std::max(worstSoFar.share, deviation / allowed);
    return deviation <= allowed;
}

/// Reports the first few places that are more than `z` standard errors apart.
void judge(const Image& a, const Image& varianceA, const Image& b, const Image& varianceB, double z,
           const std::string& what) {
    int complaints = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double va = channel(a.pixels[i], c), vb = channel(b.pixels[i], c);
            const double error = std::sqrt(double(channel(varianceA.pixels[i], c)) +
                                           double(channel(varianceB.pixels[i], c)));
            // What floats lose where there is no noise to speak of.
            const double rounding = 2e-5 * std::max(std::fabs(va), std::fabs(vb));
            if (within(std::fabs(va - vb), z * error + rounding) || ++complaints > 4) continue;
            ADD_FAILURE() << what << " " << i % std::size_t(a.width) << ","
                          << i / std::size_t(a.width) << " channel " << c << ": " << va << " and "
                          << vb << ", " << std::fabs(va - vb) / error
                          << " standard errors, allowed " << z;
        }
    }
    EXPECT_LE(complaints, 4) << what << ": in all " << complaints << " of " << 3 * a.pixels.size();
}

void expectValid(const Picture& p, const std::string& what) {
    EXPECT_EQ(p.statistics.invalidSamples, 0u)
        << what << ": "
        << (p.statistics.invalidReplays.empty() ? "" : p.statistics.invalidReplays[0]);
}

void judgeAll(const Picture& a, const Image& pixels, const Image& pixelVariance,
              const Image& blocks, const Image& blockVariance, const double mean[3],
              const double meanError[3], std::uint64_t samples, const std::string& what,
              Judge which) {
    double tests = 3;
    if (which != Judge::MeanOnly) tests += 3.0 * double(blocks.pixels.size());
    if (which == Judge::Everything) tests += 3.0 * double(pixels.pixels.size());
    const double z = threshold(tests, std::min(samples, a.pixels.sum().samples));
    if (which == Judge::Everything) {
        judge(a.pixels.image(), a.pixels.variance(), pixels, pixelVariance, z, what + ": pixel");
    }
    if (which != Judge::MeanOnly) {
        judge(a.blocks.image(), a.blocks.variance(), blocks, blockVariance, z, what + ": block");
    }
    const FilmSum::MeanColour own = a.pixels.meanColour();
    double smallest = 0;
    for (int c = 0; c < 3; ++c) {
        const double error = std::hypot(own.standardError[c], meanError[c]);
        EXPECT_TRUE(within(std::fabs(own.mean[c] - mean[c]), z * error + 2e-5 * std::fabs(mean[c])))
            << what << ": mean of channel " << c << ": " << own.mean[c] << " and " << mean[c]
            << ", " << std::fabs(own.mean[c] - mean[c]) / error << " standard errors, allowed "
            << z;
        if (mean[c] > 0) smallest = std::max(smallest, z * error / mean[c]);
    }
    std::printf("    %s: sees a bias of the mean from %.2f %% on\n", what.c_str(), 100 * smallest);
}

}  // namespace

Shot quickShot(int iterations) {
    Shot shot;
    shot.width = shot.height = 12;
    shot.maxDepth = 3;
    shot.iterations = iterations;
    shot.lightPaths = 512;
    return shot;
}

double Picture::mean() const {
    const FilmSum::MeanColour m = pixels.meanColour();
    return (m.mean[0] + m.mean[1] + m.mean[2]) / 3;
}

double Picture::standardError() const {
    // The channels of one path are correlated: they are treated as equal.
    const FilmSum::MeanColour m = pixels.meanColour();
    return (m.standardError[0] + m.standardError[1] + m.standardError[2]) / 3;
}

Render::Render(const Scene& scene, const MethodRow& row, const Shot& shot)
    : shot_(shot),
      camera_(scene.makeCamera("", {shot.width, shot.height}, shot.lens)),
      settings_(settingsOf(row, shot)),
      own_(row.create(settings_)) {
    giveCaches(*own_, row, scene, threadsOf(shot));
    start(scene, row, *own_);
}

Render::Render(const Scene& scene, const MethodRow& row, const Shot& shot, Method& method)
    : shot_(shot),
      camera_(scene.makeCamera("", {shot.width, shot.height}, shot.lens)),
      settings_(settingsOf(row, shot)) {
    start(scene, row, method);
}

void Render::start(const Scene& scene, const MethodRow& row, Method& method) {
    method_ = &method;
    RenderSettings r;
    r.transparentBackground = shot_.transparentBackground;
    r.limits = {shot_.maxDepth, shot_.rouletteDepth};
    r.seed = shot_.seed;
    r.sampling = shot_.sampling;
    r.crop = cropOf(shot_);
    r.lightPaths = lightPathsOf(settings_);
    r.glassEffort = shot_.glassEffort;
    if (shot_.guide != 0) {
        const Lights& plain = scene.lights();
        r.guides.lights =
            std::make_shared<const Lights>(plain.guidedBy(randomGuide(plain, shot_.guide)));
    }
    if (shot_.walkGuide != 0) r.guides.walks = randomWalkGuide(shot_.walkGuide);
    integrator_ = std::make_unique<BidirIntegrator>(scene, camera_, row.techniques, method, r,
                                                    threadsOf(shot_));
    integrator_->delivery().setTechniqueFilm(shot_.techniques);
    if (shot_.transparentBackground) {
        coverage_.emplace(r.crop.width(), r.crop.height());
        integrator_->setCoverageFilm(&*coverage_);
    }
    if (shot_.layers) {
        layerFilm_.emplace(*shot_.layers, r.crop.width(), r.crop.height());
        integrator_->delivery().setLayerFilm(&*layerFilm_);
    }
    integrator_->delivery().setObserver(shot_.observer);
    pixels_.resize(std::size_t(r.crop.width()) * std::size_t(r.crop.height()));
}

void Render::warmUp() {
    const std::atomic<bool> never{false};
    integrator_->beginBlock(0, *method_, never, statistics_);
}

void Render::iterate(std::uint32_t iteration) {
    const std::atomic<bool> never{false};
    integrator_->render(iteration, pixels_, never, statistics_);
}

Picture Render::run() {
    const PixelRect crop = cropOf(shot_);
    Picture picture(crop, {BlockPlan::kEndless, false, Sampler::groupOf(shot_.sampling)});
    const ThreadPool& threads = threadsOf(shot_);
    const int width = crop.width(), blocksX = picture.blocks.width();
    std::vector<Rgb> blocks(std::size_t(blocksX) * std::size_t(picture.blocks.height()));
    const int bx = std::min(4, width), by = std::min(4, crop.height());
    warmUp();
    for (int i = 0; i < shot_.iterations; ++i) {
        iterate(std::uint32_t(i));
        for (Rgb& c : pixels_) c *= shot_.gain;
        picture.pixels.add(pixels_, threads);
        std::fill(blocks.begin(), blocks.end(), Rgb{});
        for (int y = 0; y < picture.blocks.height() * by; ++y) {
            for (int x = 0; x < blocksX * bx; ++x) {
                blocks[std::size_t(y / by * blocksX + x / bx)] +=
                    pixels_[std::size_t(y * width + x)] * (1.0f / float(bx * by));
            }
        }
        picture.blocks.add(blocks, threads);
    }
    if (layerFilm_) picture.layers = layerFilm_->means();
    if (coverage_) picture.layers.merge(coverage_->means());
    picture.statistics = statistics_;
    return picture;
}

Picture render(const Scene& scene, const MethodRow& row, const Shot& shot) {
    return Render(scene, row, shot).run();
}

void expectSame(const Picture& a, const Picture& b, const std::string& what, Judge which) {
    expectValid(a, what);
    expectValid(b, what);
    const FilmSum::MeanColour m = b.pixels.meanColour();
    judgeAll(a, b.pixels.image(), b.pixels.variance(), b.blocks.image(), b.blocks.variance(),
             m.mean, m.standardError, b.pixels.sum().samples, what, which);
}

void expectRadiance(const Picture& picture, const std::vector<Rgb>& exact, const std::string& what,
                    Judge which) {
    expectValid(picture, what);
    const int width = picture.pixels.width(), height = picture.pixels.height();
    Image pixels(width, height), blocks(picture.blocks.width(), picture.blocks.height());
    pixels.pixels = exact;
    const int bx = std::min(4, width), by = std::min(4, height);
    double mean[3] = {0, 0, 0};
    const double none[3] = {0, 0, 0};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Rgb& c = pixels.at(x, y);
            for (int i = 0; i < 3; ++i) mean[i] += channel(c, i) / double(width * height);
            if (x / bx < blocks.width && y / by < blocks.height) {
                blocks.at(x / bx, y / by) += c * (1.0f / float(bx * by));
            }
        }
    }
    judgeAll(picture, pixels, Image(width, height), blocks, Image(blocks.width, blocks.height),
             mean, none, picture.pixels.sum().samples, what, which);
}

void expectRadiance(const Picture& picture, double exact, const std::string& what, Judge which) {
    const auto n = std::size_t(picture.pixels.width()) * std::size_t(picture.pixels.height());
    expectRadiance(picture, std::vector<Rgb>(n, Rgb(float(exact))), what, which);
}

std::vector<Rgb> meanOverPixels(const Camera& camera, const Shot& shot,
                                const RadianceAlong& radiance) {
    std::vector<Rgb> means;
    constexpr int kSteps = 8;
    for (int i = 0; i < shot.width * shot.height; ++i) {
        Vec3d sum;
        for (int j = 0; j < kSteps * kSteps; ++j) {
            const Vec2 raster{float(i % shot.width) + (float(j % kSteps) + 0.5f) / kSteps,
                              float(i / shot.width) + (float(j / kSteps) + 0.5f) / kSteps};
            sum += radiance(Vec3d(camera.directionAt(camera.position(), raster).direction));
        }
        sum = sum * (1.0 / (kSteps * kSteps));
        means.push_back({float(sum.x), float(sum.y), float(sum.z)});
    }
    return means;
}

double worstDeviation() {
    const bool current = worstSoFar.test == testing::UnitTest::GetInstance()->current_test_info();
    return current ? worstSoFar.share : 0.0;
}

std::vector<std::string> rowNames(Rows rows) {
    std::vector<std::string> names;
    for (const MethodRow& row : rowsOf(rows)) {
        const Merging merging = row.create(resolve(row, {}))->merging();
        if (merging.where != Merges::FirstFromEye) names.push_back(row.name);
    }
    return names;
}

std::vector<std::string> rowNamesWith(bool (Techniques::*technique)() const, Rows rows) {
    std::vector<std::string> names;
    for (const std::string& name : rowNames(rows)) {
        const MethodRow row = rowNamed(name);
        if ((asSet(row, resolve(row, {})).techniques.*technique)()) names.push_back(name);
    }
    return names;
}

std::vector<std::string> rowNamesOfWeights() {
    std::vector<std::string> names;
    for (const MethodRow& row : allRows()) names.push_back(row.name);
    for (const std::string& name : rowsWithMerge()) {
        const std::string merging = name + kMergingSuffix;
        if (std::ranges::find(names, merging) == names.end()) names.push_back(merging);
    }
    return names;
}

MethodRow rowNamed(const std::string& name) {
    for (const MethodRow& row : allRows()) {
        if (row.name == name) return row;
    }
    for (const std::string& other : rowsWithMerge()) {
        if (name == other + kMergingSuffix) return mergingRow(other);
    }
    throw std::invalid_argument(name);
}

std::string testName(const std::string& text) {
    std::string name = text;
    for (char& c : name) {
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    }
    return name;
}

bool seesThroughDeltas(const MethodRow& row) {
    return row.techniques.hits || row.techniques.connects;
}

Shot withSplatsForEveryPixel(const Shot& shot, const MethodRow& row) {
    Shot result = shot;
    if (!row.techniques.hits && !row.techniques.connects) {
        result.lightPaths = 32 * std::uint64_t(shot.width) * std::uint64_t(shot.height);
    }
    return result;
}

bool merges(const MethodRow& row) {
    return row.create(resolve(row, {}))->merging().where != Merges::Nowhere;
}

bool mergesBetweenDeltas(const MethodRow& row) {
    return row.create(resolve(row, {}))->merging().where == Merges::BetweenDeltas;
}

bool walksFromLights(const MethodRow& row) {
    if (row.techniques.splats) return true;
    const auto method = row.create(resolve(row, smallSettings(row, 4)));
    if (method->merging().where != Merges::Nowhere) return true;
    if (!row.techniques.connects) return false;
    const auto constants = method->freeze(0).constants();
    return !constants || constants->indirect > 0;
}

bool isTestRow(const MethodRow& row) {
    return row.name.starts_with("test-");
}

MethodRow withoutRefractions(MethodRow row) {
    row.techniques.refractions = row.techniques.knownWays = false;
    return row;
}

const MethodRow& pathTracer() {
    static const MethodRow row = [] {
        MethodRow byPower = findMethod("pt");
        for (Option& o : byPower.options) {
            if (o.name == "lamps") o.standard = std::string("power");
        }
        return byPower;
    }();
    return row;
}

const Picture& renderedOnce(const std::string& what, const std::function<Picture()>& picture) {
    static std::map<std::string, Picture> pictures;
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    const std::string name = test.name();  // "test/row"
    const std::string key =
        std::string(test.test_suite_name()) + "." + name.substr(0, name.find('/')) + " " + what;
    if (!pictures.contains(key)) pictures.emplace(key, picture());
    return pictures.at(key);
}

const Picture& RowTest::reference(const SceneBuilder& builder, const Shot& shot,
                                  const std::string& what) {
    return renderedOnce(what, [&] { return render(*builder.build(), pathTracer(), shot); });
}

}  // namespace lacuna::test

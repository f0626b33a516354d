#include "render/study/reference.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "libcore/methods/registry.h"
#include "render/study/run_directory.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kFirstSeed = 1'000'000;
/// Attributes of the parts' headers that also apply to their average.
constexpr const char* kShared[] = {"software",  "softwareVersion", "method", "parameters",
                                   "sceneHash", "maxDepth",        "crop",   "fullSize"};

std::string sizeText(int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
}

/// The attribute as text; "" if there is none.
std::string attributeText(const LayeredImage& image, const std::string& name) {
    const auto found = image.attributes.find(name);
    if (found == image.attributes.end()) return "";
    if (const auto* text = std::get_if<std::string>(&found->second)) return *text;
    if (const auto* integer = std::get_if<int>(&found->second)) return std::to_string(*integer);
    return std::to_string(std::get<double>(found->second));
}

/// Expected errors of a picture whose pixels are normally distributed around R with this variance:
/// E |x| = sqrt(2 / pi) sigma.
ErrorMeasures expectedError(const Image& mean, const Image& variance) {
    double sum = 0.0;
    for (const Rgb& r : mean.pixels) sum += double(r.r) + double(r.g) + double(r.b);
    ErrorMeasures e;
    e.pixels = mean.pixels.size();
    const double n = 3.0 * double(e.pixels), epsilon = 0.01 * sum / n;
    const double meanDeviation = std::sqrt(2.0 / M_PI);
    for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
        const Rgb &r = mean.pixels[i], &v = variance.pixels[i];
        const double values[] = {r.r, r.g, r.b}, variances[] = {v.r, v.g, v.b};
        for (int c = 0; c < 3; ++c) {
            const double deviation = meanDeviation * std::sqrt(variances[c]);
            e.mae += deviation / n;
            e.rmse += variances[c] / n;
            if (epsilon <= 0.0) continue;  // black: relative measures have no scale
            e.mape += deviation / (values[c] + epsilon) / n;
            e.relmse += variances[c] / (values[c] * values[c] + epsilon * epsilon) / n;
        }
    }
    e.rmse = std::sqrt(e.rmse);
    return e;
}

/// Accumulates the average of the parts in double.
class Average {
  public:
    void add(const LayeredImage& part, double iterations) {
        iterations_ += iterations;
        for (const char* name : {"R", "G", "B"}) {
            accumulate(name, part, iterations);
            accumulate(std::string("variance.") + name, part, iterations * iterations);
        }
    }
    void writeTo(LayeredImage& image) const {
        for (const auto& [name, sum] : sums_) {
            const bool variance = name.starts_with("variance");
            const double divisor = variance ? iterations_ * iterations_ : iterations_;
            std::vector<float>& channel = image.channel(name);
            for (std::size_t i = 0; i < sum.size(); ++i) channel[i] = float(sum[i] / divisor);
        }
        image.attributes["iterations"] = iterations_;
    }

  private:
    void accumulate(const std::string& name, const LayeredImage& part, double weight) {
        const std::vector<float>* values = part.find(name);
        if (!values) throw RunError("reference: expected a channel " + name + ", found none");
        std::vector<double>& sum = sums_[name];
        sum.resize(values->size());
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * double((*values)[i]);
    }

    std::map<std::string, std::vector<double>> sums_;
    double iterations_ = 0.0;
};

}  // namespace

Image cropped(const Image& image, const PixelRect& rect) {
    Image part(rect.width(), rect.height());
    for (int y = 0; y < part.height; ++y) {
        for (int x = 0; x < part.width; ++x) part.at(x, y) = image.at(rect.x0 + x, rect.y0 + y);
    }
    return part;
}

Image renderedPart(const Image& image, const SceneFacts& facts) {
    const PixelRect& crop = facts.crop;
    if (image.width == crop.width() && image.height == crop.height()) return image;
    return cropped(image, crop);
}

std::string renderReference(const StudyScene& scene, const SceneFacts& facts, int threads,
                            const std::string& directory, const std::string& renderer,
                            const std::atomic<bool>& cancel, Progress& progress) {
    const ReferenceRecipe& recipe = *scene.recipe;
    std::vector<std::string> arguments{"--method", recipe.method, "--iterations",
                                       std::to_string(recipe.iterations)};
    for (const std::string& assignment : recipe.assignments) {
        arguments.insert(arguments.end(), {"--set", assignment});
    }
    arguments.insert(arguments.end(), scene.options.begin(), scene.options.end());
    // The renderer's version is not part of the id: pictures of all versions converge to the same,
    // so that a new build need not begin anew.
    const std::string folder =
        directory + "/" + recipe.method + "-" + runId(arguments, {facts.hash});
    if (threads > 0) {
        arguments.insert(arguments.end(), {"--threads", std::to_string(threads)});
    }
    // All parts share their method's caches, because nothing is timed here.
    const MethodRow& row = findMethod(recipe.method);
    if (!needsOf(row, resolve(row, recipe.assignments)).empty()) {
        arguments.insert(arguments.end(), {"--prepare", "--cache", folder + "/cache"});
    }
    Average average;
    LayeredImage combined;
    double seconds = 0.0;
    for (std::int64_t part = 0; part < recipe.parts; ++part) {
        const RunDirectory run(folder + "/part-" + std::to_string(part));
        if (!run.complete()) {
            progress.phase("reference of " + scene.name + ", part " + std::to_string(part + 1) +
                           " of " + std::to_string(recipe.parts));
            std::vector<std::string> all = arguments;
            all.insert(all.end(), {"--seed", std::to_string(kFirstSeed + std::uint64_t(part))});
            run.render(renderer, scene.file, all, cancel);
        }
        const LayeredImage image = readExrLayers(run.image());
        if (part == 0) {
            combined = LayeredImage(image.width(), image.height());
            for (const char* name : kShared) {
                const auto found = image.attributes.find(name);
                if (found != image.attributes.end()) combined.attributes.insert(*found);
            }
        }
        average.add(image, std::stod(attributeText(image, "iterations")));
        seconds += std::stod(attributeText(image, "renderTimeSeconds"));
    }
    average.writeTo(combined);
    combined.attributes["renderTimeSeconds"] = seconds;
    combined.attributes["parts"] = int(recipe.parts);
    combined.attributes["firstSeed"] = int(kFirstSeed);
    const std::string path = folder + "/" + std::to_string(recipe.parts) + "-parts.exr";
    if (!fs::exists(path)) writeExr(path, combined);
    return path;
}

Reference openReference(const std::string& path, const SceneFacts& facts,
                        const std::vector<StudyCrop>& crops) {
    Reference reference;
    reference.path = path;
    LayeredImage image;
    if (endingOf(path) == ".exr") {
        image = readExrLayers(path);
        if (!image.hasRgb("")) {
            throw InputError(path + ": expected the channels R, G, B, found others");
        }
    } else {
        const Image picture = readImage(path);
        image = LayeredImage(picture.width, picture.height);
        image.setRgb("", picture);
    }
    const PixelRect& crop = facts.crop;
    const bool whole = image.width() == facts.width && image.height() == facts.height;
    if (!whole && (image.width() != crop.width() || image.height() != crop.height())) {
        throw InputError(path + ": expected " + sizeText(facts.width, facts.height) +
                         " pixels, as the scene is rendered, found " +
                         sizeText(image.width(), image.height()) +
                         "; render it at that size or change width and height in the study");
    }
    const std::string scene = attributeText(image, "sceneHash");
    if (!scene.empty() && scene != facts.contentHash) {
        throw InputError(path + ": expected a picture of the scene with hash " + facts.contentHash +
                         ", found one of " + scene + "; render it again");
    }
    const std::string depth = attributeText(image, "maxDepth");
    if (!depth.empty() && depth != std::to_string(facts.maxDepth)) {
        throw InputError(path + ": expected paths of up to " + std::to_string(facts.maxDepth) +
                         " edges, found maxDepth " + depth +
                         "; render it again or set max-depth in the study");
    }
    const ErrorReference usable(image.rgb(""), path);
    const Image picture = renderedPart(usable.image(), facts);
    std::optional<Image> variance;
    if (image.hasRgb("variance")) {
        variance = renderedPart(image.rgb("variance"), facts);
        reference.ownError = expectedError(picture, *variance);
    }
    for (const StudyCrop& c : crops) {
        CropReference part{ErrorReference(cropped(picture, c.rect), path), std::nullopt};
        if (variance) {
            part.ownError = expectedError(part.picture.image(), cropped(*variance, c.rect));
        }
        reference.crops.push_back(std::move(part));
    }
    reference.hash = hashOfFile(path);
    const std::string method = attributeText(image, "method");
    const std::string iterations = attributeText(image, "iterations");
    reference.origin =
        method.empty() || iterations.empty()
            ? "an image that does not say how it was made"
            : method + ", " + std::to_string(std::llround(std::stod(iterations))) + " iterations";
    return reference;
}

}  // namespace lacuna

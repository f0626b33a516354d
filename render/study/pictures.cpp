#include "render/study/pictures.h"

#include <nlohmann/json.hpp>

#include "libcore/image/image_io.h"
#include "render/study/embed.h"
#include "render/study/techniques.h"

namespace lacuna {
namespace {

using nlohmann::json;

/// Factors by which pictures and crops must be shrunk to stay within their limits of bytes.
struct Shrinking {
    int pictures = 1, crops = 1;
};

Shrinking shrinkingOf(const Results& results) {
    double pictures = 0.0, crops = 0.0;
    const double each = double(results.study.methods.size() + 1);
    for (const SceneFacts& facts : results.facts) {
        pictures += each * double(facts.crop.width()) * double(facts.crop.height());
    }
    for (const StudyScene& scene : results.study.scenes) {
        for (const StudyCrop& crop : scene.crops) {
            crops += each * double(crop.rect.width()) * double(crop.rect.height());
        }
    }
    return {shrinkFactor(pictures, kPictureBytes), shrinkFactor(crops, kCropBytes)};
}

json pictureJson(const std::string& name, int method, std::uint64_t seed, const Image& image,
                 int stops) {
    return {
        {"name", name}, {"method", method}, {"seed", seed}, {"pixels", pixelsText(image, stops)}};
}

json errorsJson(const ErrorMeasures& e) {
    return {{"mae", e.mae}, {"rmse", e.rmse}, {"mape", e.mape}, {"relmse", e.relmse}};
}

json sizeJson(const Image& image, int shrink, int stops) {
    return {{"width", image.width}, {"height", image.height}, {"shrink", shrink}, {"stops", stops}};
}

json sceneJson(const Results& results, std::size_t s, const Shrinking& shrink) {
    const std::vector<StudyCrop>& crops = results.study.scenes[s].crops;
    const Image reference = renderedPart(readImage(results.references[s].path), results.facts[s]);
    const int stops = stopsFor(meanOf(reference));
    const auto part = [&](const Image& image, std::size_t c) {
        return shrunk(cropped(image, crops[c].rect), shrink.crops);
    };
    const Image small = shrunk(reference, shrink.pictures);
    json scene = sizeJson(small, shrink.pictures, stops);
    scene["pictures"] = json::array({pictureJson("reference", -1, 0, small, stops)});
    scene["crops"] = json::array();
    for (std::size_t c = 0; c < crops.size(); ++c) {
        const Image smallPart = part(reference, c);
        const PixelRect& r = crops[c].rect;
        json crop = sizeJson(smallPart, shrink.crops, stops);
        crop["name"] = crops[c].name;
        crop["rect"] = json::array({r.x0, r.y0, r.width(), r.height()});
        crop["pictures"] = json::array({pictureJson("reference", -1, 0, smallPart, stops)});
        scene["crops"].push_back(std::move(crop));
    }
    for (std::size_t m = 0; m < results.study.methods.size(); ++m) {
        const RunResult& run = *results.of(s, m).front();
        const std::string& name = results.study.methods[m].name;
        const Image image = readImage(run.image);
        scene["pictures"].push_back(
            pictureJson(name, int(m), run.run.seed, shrunk(image, shrink.pictures), stops));
        for (std::size_t c = 0; c < crops.size(); ++c) {
            json picture = pictureJson(name, int(m), run.run.seed, part(image, c), stops);
            picture["errors"] = errorsJson(run.cropErrors[c]);
            scene["crops"][c]["pictures"].push_back(std::move(picture));
        }
    }
    return scene;
}

}  // namespace

json picturesJson(const Results& results) {
    json scenes = json::array();
    const Shrinking shrink = shrinkingOf(results);
    for (std::size_t s = 0; s < results.study.scenes.size(); ++s) {
        json scene = sceneJson(results, s, shrink);
        scene["techniques"] = techniquesJson(results, s, scene.at("stops"));
        scenes.push_back(std::move(scene));
    }
    return scenes;
}

}  // namespace lacuna

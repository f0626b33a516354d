#include "render/study/techniques.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "libcore/bidir/technique_film.h"
#include "libcore/image/exr.h"
#include "render/study/embed.h"

namespace lacuna {
namespace {

using nlohmann::json;

/// Number of techniques for paths of 1 to `edges` edges. A path of k edges has k + 1 techniques: t
/// from 1 to k + 1, s = k + 1 - t.
double techniqueCount(int edges) {
    return edges * (edges + 3.0) / 2.0;
}

int shrinkOf(const Results& results) {
    const Study& study = results.study;
    double pixels = 0.0;
    for (const SceneFacts& facts : results.facts) {
        pixels += double(facts.crop.width()) * double(facts.crop.height()) *
                  double(study.methods.size()) * techniqueCount(study.techniques->edges);
    }
    return shrinkFactor(2.0 * pixels, kTechniqueBytes);
}

/// The standard deviation, from a channel of variances.
Image deviation(const LayeredImage& image, const std::string& channel) {
    const std::vector<float>& variances = *image.find(channel);
    Image root(image.width(), image.height());
    for (std::size_t i = 0; i < variances.size(); ++i) {
        root.pixels[i] = Rgb(std::sqrt(variances[i]));
    }
    return root;
}

json pyramidJson(const Results& results, const TechniqueResult& result, int shrink, int stops) {
    const LayeredImage image = readExrLayers(result.image);
    const double mean = meanOf(image.rgb());
    const auto share = [&](const Image& layer) { return mean > 0.0 ? meanOf(layer) / mean : 0.0; };
    json layers = json::array();
    double longer = 0.0;
    const int longest = result.report.at("max_depth");
    for (int k = 1; k <= longest; ++k) {
        for (int t = k + 1; t >= 1; --t) {
            const int s = k + 1 - t;
            const std::string name = TechniqueFilm::layerName(s, t);
            if (!image.hasRgb("weighted." + name)) continue;
            const Image layer = image.rgb("weighted." + name);
            if (k > results.study.techniques->edges) {
                longer += share(layer);
                continue;
            }
            const Image noise = deviation(image, "variance." + name);
            layers.push_back({{"s", s},
                              {"t", t},
                              {"share", share(layer)},
                              {"pixels", pixelsText(shrunk(layer, shrink), stops)},
                              {"noise_share", share(noise)},
                              {"noise", pixelsText(shrunk(noise, shrink), stops)}});
        }
    }
    return {{"name", results.study.methods[result.run.method].name},
            {"iterations", result.report.at("iterations")},
            {"seed", result.run.seed},
            {"command_line", result.report.at("command_line")},
            {"longer", longer},
            {"costs", result.report.at("techniques")},
            {"layers", std::move(layers)}};
}

}  // namespace

json techniquesJson(const Results& results, std::size_t scene, int stops) {
    if (!results.study.techniques) return nullptr;
    const int shrink = shrinkOf(results);
    const PixelRect& rendered = results.facts[scene].crop;
    const Image size = shrunk(Image(rendered.width(), rendered.height()), shrink);
    json pyramids = json::array();
    for (const TechniqueResult& result : results.techniques) {
        if (result.run.scene != scene) continue;
        pyramids.push_back(pyramidJson(results, result, shrink, stops));
    }
    return {{"width", size.width},
            {"height", size.height},
            {"shrink", shrink},
            {"stops", stops},
            {"edges", results.study.techniques->edges},
            {"pyramids", std::move(pyramids)}};
}

}  // namespace lacuna

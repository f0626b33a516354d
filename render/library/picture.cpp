#include "lacuna/picture.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "libcore/base/error.h"
#include "libcore/image/channels.h"
#include "libcore/image/error_metrics.h"
#include "libcore/image/exr.h"
#include "libcore/image/image.h"
#include "libcore/image/image_io.h"
#include "render/relight.h"

namespace lacuna {
namespace {

std::string headerText(const LayeredImage& image) {
    nlohmann::json header = nlohmann::json::object();
    for (const auto& [name, value] : image.attributes) {
        std::visit([&, &key = name](const auto& v) { header[key] = v; }, value);
    }
    return header.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

struct Picture::Content {
    LayeredImage image;
    Image rgb;
    std::string statistics;
};

Picture::Picture(LayeredImage image, std::string statistics) {
    Image rgb = image.rgb();
    content_ = std::make_shared<const Content>(
        Content{std::move(image), std::move(rgb), std::move(statistics)});
}

namespace {

LayeredImage layered(int width, int height, std::span<const float> rgb) {
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide ||
        rgb.size() != 3 * std::size_t(width) * std::size_t(height)) {
        throw UsageError("picture: expected width x height x 3 values, found " +
                         std::to_string(rgb.size()) + " for " + std::to_string(width) + " x " +
                         std::to_string(height));
    }
    Image image(width, height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]};
    }
    LayeredImage result(width, height);
    result.setRgb("", image);
    return result;
}

}  // namespace

Picture::Picture(int width, int height, std::span<const float> rgb)
    : Picture(layered(width, height, rgb), "{}") {}

Picture Picture::load(const std::string& path) {
    if (endingOf(path) == ".exr") {
        LayeredImage image = readExrLayers(path);
        if (!image.hasRgb("")) image.setRgb("", readExr(path));  // throws: says what is missing
        std::string header = headerText(image);
        return {std::move(image), std::move(header)};
    }
    const Image rgb = readImage(path);
    LayeredImage image(rgb.width, rgb.height);
    image.setRgb("", rgb);
    return {std::move(image), "{}"};
}

int Picture::width() const {
    return content_->rgb.width;
}
int Picture::height() const {
    return content_->rgb.height;
}

std::span<const float> Picture::rgb() const {
    return channelsOf(std::span(content_->rgb.pixels));
}

std::vector<std::string> Picture::channels() const {
    std::vector<std::string> names;
    for (const auto& [name, plane] : content_->image.channels()) names.push_back(name);
    return names;
}

std::span<const float> Picture::channel(const std::string& name) const {
    const std::vector<float>* plane = content_->image.find(name);
    if (!plane) {
        throw UsageError("channel: expected one of the picture's, found '" + name +
                         "'; channels() lists them");
    }
    return *plane;
}

const std::string& Picture::statistics() const {
    return content_->statistics;
}

Picture Picture::relight(const std::map<std::string, std::array<double, 3>>& factors) const {
    LayeredImage image = lacuna::relight(content_->image, factors, "picture");
    std::string header = headerText(image);
    return {std::move(image), std::move(header)};
}

void Picture::save(const std::string& path) const {
    writeImage(path, content_->image);
}

Errors Picture::compare(const Picture& reference) const {
    const ErrorMeasures m = ErrorReference(reference.content_->rgb).compare(content_->rgb);
    return {m.mae, m.rmse, m.mape, m.relmse};
}

}  // namespace lacuna

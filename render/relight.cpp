#include "render/relight.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "libcore/base/error.h"
#include "libcore/base/number_text.h"
#include "libcore/base/text_list.h"
#include "libcore/bidir/light_noise.h"
#include "libcore/bidir/path_layers.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr const char* kSuffixes[] = {".R", ".G", ".B"};
constexpr const char* kPictureChannels[] = {"R", "G", "B"};

const std::string* textOf(const LayeredImage& image, const char* attribute) {
    const auto found = image.attributes.find(attribute);
    return found == image.attributes.end() ? nullptr : std::get_if<std::string>(&found->second);
}

/// JSON of the header as a T. Throws InputError.
template <class T>
T parsed(const std::string& text, const char* attribute, const std::string& path) {
    try {
        return json::parse(text).get<T>();
    } catch (const json::exception& e) {
        throw InputError(path + ": expected " + attribute + " as lacuna-render writes it, found " +
                         "a damaged one (" + e.what() + "); name another file");
    }
}

/// Whether a layer depends on the light or on how it was found, so that it is valid for the old
/// light only.
bool isOfTheOldLight(const std::string& layer, const std::map<std::string, std::string>& layers) {
    constexpr const char* kKinds[] = {
        "weighted",   "unweighted", "variance", "share",         "part",     "sum",  "product",
        "covariance", "emission",   "walks",    "lightSubspace", "subspace", "node", "light"};
    const std::string kind = layer.substr(0, layer.find('.'));
    return std::ranges::find(kKinds, kind) != std::end(kKinds) || layers.contains(layer);
}

/// A copy with the layers of geometry and the attributes that remain valid.
LayeredImage withoutLight(const LayeredImage& image, const std::string& path) {
    std::map<std::string, std::string> layers;
    if (const std::string* text = textOf(image, "layers")) {
        layers = parsed<std::map<std::string, std::string>>(*text, "layers", path);
    }
    LayeredImage result(image.width(), image.height());
    result.attributes = image.attributes;
    for (const char* attribute : {"layers", "partHash", "partInputs", "partSums", "partTotals"}) {
        result.attributes.erase(attribute);
    }
    for (const auto& [name, plane] : image.channels()) {
        const std::size_t dot = name.rfind('.');
        const std::string layer = dot == name.npos ? "" : name.substr(0, dot);
        const bool picture =
            std::ranges::find(kPictureChannels, name) != std::end(kPictureChannels);
        if (!picture && !isOfTheOldLight(layer, layers)) result.channel(name) = plane;
    }
    return result;
}

/// The factor of each group; 1 if none is given.
std::vector<LightFactor> factorsOf(const std::vector<std::string>& groups,
                                   const LightFactors& given) {
    for (const auto& [group, factor] : given) {
        if (std::ranges::find(groups, group) == groups.end()) {
            throw UsageError("light: expected a group of this picture (" + joined(groups, ", ") +
                             "), found '" + group + "'");
        }
        for (const double f : factor) {
            if (std::isfinite(f) && f >= 0.0) continue;
            throw UsageError("light " + group + ": expected factors of 0 or more, found " +
                             numberText(f));
        }
    }
    std::vector<LightFactor> factors;
    for (const std::string& group : groups) {
        const auto found = given.find(group);
        factors.push_back(found == given.end() ? LightFactor{1.0, 1.0, 1.0} : found->second);
    }
    return factors;
}

std::vector<float> scaled(const std::vector<float>& plane, double factor) {
    std::vector<float> result(plane.size());
    for (std::size_t i = 0; i < plane.size(); ++i) result[i] = float(double(plane[i]) * factor);
    return result;
}

std::vector<float> sumOf(const std::vector<std::vector<float>>& planes) {
    std::vector<float> sum(planes.front().size());
    for (std::size_t i = 0; i < sum.size(); ++i) {
        double total = 0.0;
        for (const std::vector<float>& plane : planes) total += double(plane[i]);
        sum[i] = float(total);
    }
    return sum;
}

void requireFinite(const std::vector<float>& plane) {
    if (std::ranges::all_of(plane, [](float v) { return std::isfinite(v); })) return;
    throw UsageError(
        "light: expected factors under which pixels fit into a float, found larger "
        "ones; choose smaller factors");
}

/// One channel of the result.
class Channel {
  public:
    Channel(const LayeredImage& image, const std::vector<std::string>& groups,
            const std::vector<LightFactor>& factors, std::size_t channel)
        : image_(image), groups_(groups), channel_(channel) {
        for (const LightFactor& f : factors) factors_.push_back(f[channel]);
    }

    void addTo(LayeredImage& result) const {
        std::vector<std::vector<float>> lights;
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            const std::string name = lightLayer(groups_[g]) + kSuffixes[channel_];
            lights.push_back(scaled(*image_.find(name), factors_[g]));
            result.channel(name) = lights.back();
        }
        // A factor common to all groups multiplies the picture itself, so that a factor of 1 preserves every bit.
        const std::vector<float>& old = *image_.find(kPictureChannels[channel_]);
        std::vector<float>& picture = result.channel(kPictureChannels[channel_]);
        picture = sameForAll() ? scaled(old, factors_.front()) : sumOf(lights);
        requireFinite(picture);
        addCovariances(result);
        if (std::optional<std::vector<float>> v = variance(result)) {
            result.channel(std::string("variance") + kSuffixes[channel_]) = std::move(*v);
        }
    }

  private:
    bool sameForAll() const {
        return std::ranges::all_of(factors_, [&](double f) { return f == factors_.front(); });
    }

    void addCovariances(LayeredImage& result) const {
        for (std::size_t a = 0; a < groups_.size(); ++a) {
            for (std::size_t b = a; b < groups_.size(); ++b) {
                const std::string name = lightCovarianceLayer(a, b) + kSuffixes[channel_];
                if (const std::vector<float>* plane = image_.find(name)) {
                    result.channel(name) = scaled(*plane, factors_[a] * factors_[b]);
                }
            }
        }
    }

    /// The variance of the sum of the groups: the sum of their variances and twice each covariance.
    std::optional<std::vector<float>> variance(const LayeredImage& result) const {
        const std::vector<float>* old = image_.find(std::string("variance") + kSuffixes[channel_]);
        if (old && sameForAll()) return scaled(*old, factors_.front() * factors_.front());
        std::vector<double> sum(std::size_t(image_.width()) * std::size_t(image_.height()));
        for (std::size_t a = 0; a < groups_.size(); ++a) {
            for (std::size_t b = a; b < groups_.size(); ++b) {
                const auto* plane = result.find(lightCovarianceLayer(a, b) + kSuffixes[channel_]);
                if (!plane) return std::nullopt;
                const double times = a == b ? 1.0 : 2.0;
                for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += times * double((*plane)[i]);
            }
        }
        std::vector<float> variance(sum.size());
        for (std::size_t i = 0; i < sum.size(); ++i) variance[i] = float(std::max(0.0, sum[i]));
        return variance;
    }

    const LayeredImage& image_;
    const std::vector<std::string>& groups_;
    std::size_t channel_;
    std::vector<double> factors_;
};

/// The total factors of all groups since the render, as text.
std::string relitText(const LayeredImage& image, const std::vector<std::string>& groups,
                      const std::vector<LightFactor>& factors, const std::string& path) {
    LightFactors all;
    if (const std::string* before = textOf(image, "relit")) {
        all = parsed<LightFactors>(*before, "relit", path);
    }
    for (std::size_t g = 0; g < groups.size(); ++g) {
        LightFactor& factor = all.try_emplace(groups[g], LightFactor{1.0, 1.0, 1.0}).first->second;
        for (std::size_t c = 0; c < 3; ++c) factor[c] *= factors[g][c];
    }
    return json(all).dump();
}

}  // namespace

void addLightFactor(LightFactors& factors, const std::string& option, const std::string& text) {
    const std::size_t equals = text.rfind('=');  // names may contain one
    const std::string group = text.substr(0, equals);
    const std::vector<std::string_view> parts = splitAtCommas(
        std::string_view(text).substr(equals == text.npos ? text.size() : equals + 1));
    std::vector<double> numbers;
    for (const std::string_view part : parts) {
        const std::optional<double> number = parseNumber(std::string(part));
        if (number && std::isfinite(*number) && *number >= 0.0) numbers.push_back(*number);
    }
    const bool one = numbers.size() == 1, three = numbers.size() == 3;
    if (equals == text.npos || group.empty() || numbers.size() != parts.size() || !(one || three)) {
        throw UsageError(option + ": expected GROUP=FACTOR or GROUP=R,G,B, numbers of 0 or more, " +
                         "found '" + text + "'");
    }
    const LightFactor factor{numbers.front(), numbers[three ? 1 : 0], numbers[three ? 2 : 0]};
    if (!factors.emplace(group, factor).second) {
        throw UsageError(option + ": expected each group once, found '" + group + "' twice");
    }
}

std::vector<std::string> lightGroupsOf(const LayeredImage& image, const std::string& path) {
    const std::string* text = textOf(image, "lightGroups");
    if (!text) return {};
    auto groups = parsed<std::vector<std::string>>(*text, "lightGroups", path);
    for (const std::string& group : groups) {
        if (image.hasRgb(lightLayer(group))) continue;
        throw InputError(path + ": expected a layer " + lightLayer(group) +
                         ", which the header names, found none; name another file");
    }
    return groups;
}

LayeredImage relight(const LayeredImage& image, const LightFactors& given,
                     const std::string& path) {
    const std::vector<std::string> groups = lightGroupsOf(image, path);
    if (groups.empty()) {
        throw InputError(path +
                         ": expected a layer for each group of lights, found none; render it with "
                         "--light-groups");
    }
    if (!image.hasRgb("")) {
        throw InputError(path + ": expected a picture, channels R, G and B, found none");
    }
    const std::vector<LightFactor> factors = factorsOf(groups, given);
    LayeredImage result = withoutLight(image, path);
    for (std::size_t c = 0; c < 3; ++c) Channel(image, groups, factors, c).addTo(result);
    result.attributes["relit"] = relitText(image, groups, factors, path);
    return result;
}

}  // namespace lacuna

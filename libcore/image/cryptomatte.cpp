#include "libcore/image/cryptomatte.h"

#include <murmurhash.h>

#include <bit>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace lacuna {
namespace {

std::uint32_t murmurHash(std::string_view text) {
    std::uint32_t hash = 0;
    lmmh_x86_32(text.data(), unsigned(text.size()), 0, &hash);
    return hash;
}

/// A colour for an id, bright enough to be visible.
Rgb colourOf(float id) {
    const auto bits = std::bit_cast<std::uint32_t>(id);
    const auto part = [&](int shift) { return 0.1f + 0.9f * float(bits >> shift & 255) / 255.0f; };
    return {part(0), part(8), part(16)};
}

std::string hexText(std::uint32_t bits) {
    char text[9];
    std::snprintf(text, sizeof text, "%08x", bits);
    return text;
}

}  // namespace

std::uint32_t cryptomatteBits(std::string_view name) {
    const std::uint32_t hash = murmurHash(name), exponent = hash >> 23 & 255;
    return exponent == 0 || exponent == 255 ? hash ^ (1u << 23) : hash;
}

LayeredImage cryptomattePictures(const LayeredImage& image) {
    LayeredImage pictures(image.width(), image.height());
    for (const auto& [name, plane] : image.channels()) {
        const std::size_t dot = name.rfind('.');
        const bool ids = name.starts_with("Crypto") && dot != std::string::npos &&
                         (name.ends_with(".R") || name.ends_with(".B"));
        if (!ids) continue;
        const std::vector<float>* shares =
            image.find(name.substr(0, dot) + (name.ends_with(".R") ? ".G" : ".A"));
        if (!shares) continue;
        const std::string type = name.substr(0, dot - 2);
        std::vector<float>&r = pictures.channel(type + ".R"), &g = pictures.channel(type + ".G"),
        &b = pictures.channel(type + ".B");
        for (std::size_t i = 0; i < plane.size(); ++i) {
            const Rgb colour = colourOf(plane[i]) * (*shares)[i];
            r[i] += colour.r;
            g[i] += colour.g;
            b[i] += colour.b;
        }
    }
    return pictures;
}

void addCryptomatte(LayeredImage& image, const Matte& matte) {
    if (matte.pixels.size() != std::size_t(image.width()) * std::size_t(image.height())) {
        throw std::invalid_argument("Cryptomatte of another size than its image");
    }
    nlohmann::json manifest = nlohmann::json::object();
    std::vector<float> ids;
    for (const std::string& name : matte.names) {
        const std::uint32_t bits = cryptomatteBits(name);
        ids.push_back(std::bit_cast<float>(bits));
        manifest[name] = hexText(bits);
    }
    for (std::size_t rank = 0; rank < Matte::kRanks; ++rank) {
        const std::string layer = matte.type + "0" + std::to_string(rank / 2);
        std::vector<float>& id = image.channel(layer + (rank % 2 ? ".B" : ".R"));
        std::vector<float>& share = image.channel(layer + (rank % 2 ? ".A" : ".G"));
        for (std::size_t i = 0; i < matte.pixels.size(); ++i) {
            const Matte::Cover& cover = matte.pixels[i][rank];
            if (!(cover.share > 0.0f)) continue;
            id[i] = ids[cover.name];
            share[i] = cover.share;
        }
    }
    const std::string key = "cryptomatte/" + hexText(murmurHash(matte.type)).substr(0, 7) + "/";
    auto& a = image.attributes;
    a[key + "name"] = matte.type;
    a[key + "hash"] = std::string("MurmurHash3_32");
    a[key + "conversion"] = std::string("uint32_to_float32");
    a[key + "manifest"] = manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace lacuna

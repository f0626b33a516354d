#include "libcore/scene/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lacuna {

namespace {

struct Decoder {
    std::array<float, 256> linear{}, srgb{};
    Decoder() {
        for (int i = 0; i < 256; ++i) {
            const double c = i / 255.0;
            linear[i] = float(c);
            srgb[i] = float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
        }
    }
};

int wrapped(int i, int n, Texture::Wrap wrap) {
    if (unsigned(i) < unsigned(n)) return i;  // the usual case, without a division
    switch (wrap) {
        case Texture::Wrap::ClampToEdge:
            return i < 0 ? 0 : i >= n ? n - 1 : i;
        case Texture::Wrap::MirroredRepeat: {
            const int period = ((i % (2 * n)) + 2 * n) % (2 * n);
            return period < n ? period : 2 * n - 1 - period;
        }
        case Texture::Wrap::Repeat:
            break;
    }
    const int r = i % n;
    return r < 0 ? r + n : r;
}

/// Texel coordinate of u. It keeps the fraction of large |u|; repeat modes are periodic.
double texelCoordinate(float u, int n, Texture::Wrap wrap) {
    double x = u;
    if (wrap == Texture::Wrap::Repeat) x -= std::floor(x);
    if (wrap == Texture::Wrap::MirroredRepeat) x -= 2.0 * std::floor(0.5 * x);
    if (wrap == Texture::Wrap::ClampToEdge) x = std::min(std::max(x, -1.0), 2.0);
    return x * n - 0.5;
}

/// The four texels around a point, and its fractional position between the first and the second
/// ones. Without interpolation, only the first texel counts.
struct Footprint {
    int x[2], y[2];
    float fx, fy;

    Footprint(const Texture& texture, Vec2 uv) {
        const double centre = texture.nearest ? 0.5 : 0.0;
        const double u = texelCoordinate(uv.x, texture.width, texture.wrapU) + centre;
        const double v = texelCoordinate(uv.y, texture.height, texture.wrapV) + centre;
        const int x0 = int(std::floor(u)), y0 = int(std::floor(v));
        fx = texture.nearest ? 0.0f : float(u - x0);
        fy = texture.nearest ? 0.0f : float(v - y0);
        for (int i = 0; i < 2; ++i) {
            x[i] = wrapped(x0 + i, texture.width, texture.wrapU);
            y[i] = wrapped(y0 + i, texture.height, texture.wrapV);
        }
    }
};

const std::uint8_t* texelOf(const Texture& texture, int x, int y) {
    return texture.rgba.data() + (std::size_t(y) * std::size_t(texture.width) + std::size_t(x)) * 4;
}

const Decoder& decoder() {
    static const Decoder tables;
    return tables;
}

const std::array<float, 256>& tableOf(const Texture& texture) {
    return texture.srgb ? decoder().srgb : decoder().linear;
}

}  // namespace

Rgba sampleTexture(const Texture& texture, Vec2 uv) {
    const std::array<float, 256>& table = tableOf(texture);
    const std::array<float, 256>& linear = decoder().linear;
    const Footprint at(texture, uv);
    Rgba sum{Rgb{}, 0.0f};
    for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
            const float w = (i ? at.fx : 1.0f - at.fx) * (j ? at.fy : 1.0f - at.fy);
            const std::uint8_t* t = texelOf(texture, at.x[i], at.y[j]);
            sum.rgb += Rgb{table[t[0]], table[t[1]], table[t[2]]} * w;
            sum.alpha += linear[t[3]] * w;
        }
    }
    return sum;
}

float leastGreen(const Texture& texture) {
    std::uint8_t least = 255;
    for (std::size_t i = 1; i < texture.rgba.size(); i += 4) {
        least = std::min(least, texture.rgba[i]);
    }
    return tableOf(texture)[least];
}

void prefetchTexture(const Texture& texture, Vec2 uv) {
    const Footprint at(texture, uv);
    // The second column is nearly always in the same cache line.
    for (const int y : at.y) __builtin_prefetch(texelOf(texture, at.x[0], y));
}

}  // namespace lacuna

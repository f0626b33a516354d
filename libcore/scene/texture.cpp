#include "libcore/scene/texture.h"

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
    if (unsigned(i) < unsigned(n)) return i;  // nearly always, and without a division
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

/// Texel coordinate of u without losing the fraction to large |u|; repeat modes are periodic.
double texelCoordinate(float u, int n, Texture::Wrap wrap) {
    double x = u;
    if (wrap == Texture::Wrap::Repeat) x -= std::floor(x);
    if (wrap == Texture::Wrap::MirroredRepeat) x -= 2.0 * std::floor(0.5 * x);
    if (wrap == Texture::Wrap::ClampToEdge) x = std::min(std::max(x, -1.0), 2.0);
    return x * n - 0.5;
}

}  // namespace

Rgba sampleTexture(const Texture& texture, Vec2 uv) {
    static const Decoder decoder;
    const std::array<float, 256>& table = texture.srgb ? decoder.srgb : decoder.linear;

    const double x = texelCoordinate(uv.x, texture.width, texture.wrapU);
    const double y = texelCoordinate(uv.y, texture.height, texture.wrapV);
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const float fx = float(x - x0), fy = float(y - y0);
    const int xs[2] = {wrapped(x0, texture.width, texture.wrapU),
                       wrapped(x0 + 1, texture.width, texture.wrapU)};
    const int ys[2] = {wrapped(y0, texture.height, texture.wrapV),
                       wrapped(y0 + 1, texture.height, texture.wrapV)};

    Rgba sum{Rgb{}, 0.0f};
    for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
            const float w = (i ? fx : 1.0f - fx) * (j ? fy : 1.0f - fy);
            const std::uint8_t* t =
                texture.rgba.data() + (std::size_t(ys[j]) * texture.width + xs[i]) * 4;
            sum.rgb += Rgb{table[t[0]], table[t[1]], table[t[2]]} * w;
            sum.alpha += decoder.linear[t[3]] * w;
        }
    }
    return sum;
}

}  // namespace lacuna

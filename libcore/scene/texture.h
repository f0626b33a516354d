// Texture look-ups: bilinear or nearest, without mip maps, because f must not depend on the strategy that
// asks.
#pragma once

#include <span>

#include "libcore/base/vec.h"
#include "libcore/scene/material.h"

namespace lacuna {

struct Rgba {
    Rgb rgb;
    float alpha = 1.0f;
};

/// Linear colour and alpha at `uv` (glTF: origin at the image's upper left corner, texel centres at
/// half integers). The texture must have at least one texel.
Rgba sampleTexture(const Texture& texture, Vec2 uv);

/// The least of all texels' G, linear where the texture is: sampleTexture() gives nothing below but by rounding.
float leastGreen(const Texture& texture);

/// The texture that `use` names, at the point with these coordinates of either set.
inline Rgba sampleTexture(std::span<const Texture> textures, const TextureUse& use, Vec2 uv,
                          Vec2 uv1) {
    return sampleTexture(textures[std::size_t(use.value)], use.at(use.secondSet ? uv1 : uv));
}

/// Asks the cache for what sampleTexture will look at.
void prefetchTexture(const Texture& texture, Vec2 uv);

}  // namespace lacuna

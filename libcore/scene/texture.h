// Texture look-ups: bilinear or nearest, without mip maps, because f must not depend on the strategy that evaluates it.
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

/// The smallest G of all texels, decoded: sampleTexture() returns nothing smaller, but for rounding.
float leastGreen(const Texture& texture);

/// Samples the texture of `use` at the point with these coordinates of both sets.
inline Rgba sampleTexture(std::span<const Texture> textures, const TextureUse& use, Vec2 uv,
                          Vec2 uv1) {
    return sampleTexture(textures[std::size_t(use.value)], use.at(use.secondSet ? uv1 : uv));
}

/// Prefetches the texels that sampleTexture will read.
void prefetchTexture(const Texture& texture, Vec2 uv);

}  // namespace lacuna

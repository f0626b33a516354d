// Which points of a triangle are there: glTF's alpha coverage, MASK and BLEND.
#pragma once

#include <array>

#include "libcore/base/vec.h"
#include "libcore/scene/material.h"

namespace lacuna {

/// What the opacity of one triangle's points is made of.
struct TriangleAlpha {
    const Material* material = nullptr;
    const Texture* texture = nullptr;  ///< of the base colour, whose alpha counts; null: none
    std::array<Vec2, 3> uvs{};         ///< the mesh's, of the set that the texture lies by
    std::array<float, 3> corners{1.0f, 1.0f, 1.0f};  ///< alpha of the vertex colours

    /// The probability that a ray that comes by meets the point: alpha for BLEND, 0 or 1 for MASK,
    /// 1 for OPAQUE. `barycentric`: weights of the second and the third corner.
    float opacity(Vec2 barycentric) const;
    /// Whether points may differ.
    bool varies() const { return texture || corners[0] != corners[1] || corners[1] != corners[2]; }
};

/// Whether rays can pass through some points of a material; `vertexAlpha`: some vertex colours are
/// translucent.
bool mayHaveHoles(const Material& material, std::span<const Texture> textures, bool vertexAlpha);

}  // namespace lacuna

// glTF's alpha coverage, MASK and BLEND: which points of a triangle stop rays.
#pragma once

#include <array>

#include "libcore/base/vec.h"
#include "libcore/scene/material.h"

namespace lacuna {

/// The data that determine the opacity of a triangle's points.
struct TriangleAlpha {
    const Material* material = nullptr;
    const Texture* texture = nullptr;  ///< base colour texture, whose alpha counts; null: none
    std::array<Vec2, 3> uvs{};         ///< the triangle's coordinates of the texture's set
    std::array<float, 3> corners{1.0f, 1.0f, 1.0f};  ///< alpha of the vertex colours

    /// The probability that the point stops a ray: alpha for BLEND, 0 or 1 for MASK, 1 for OPAQUE.
    /// `barycentric`: weights of the second and the third corner.
    float opacity(Vec2 barycentric) const;
    /// Whether the opacity may vary over the triangle.
    bool varies() const { return texture || corners[0] != corners[1] || corners[1] != corners[2]; }
};

/// Whether rays can pass through some points of a material. `vertexAlpha`: whether some vertex
/// colours are translucent.
bool mayHaveHoles(const Material& material, std::span<const Texture> textures, bool vertexAlpha);

}  // namespace lacuna

#include "libcore/scene/alpha.h"

#include "libcore/scene/texture.h"

namespace lacuna {

float TriangleAlpha::opacity(Vec2 b) const {
    const Material& m = *material;
    if (m.alphaMode == Material::Alpha::Opaque) return 1.0f;
    const float w = 1.0f - b.x - b.y;
    float alpha = m.baseAlpha;
    if (texture) {
        const Vec2 uv = uvs[0] * w + uvs[1] * b.x + uvs[2] * b.y;
        alpha *= sampleTexture(*texture, m.baseColorTexture.at(uv)).alpha;
    }
    alpha *= corners[0] * w + corners[1] * b.x + corners[2] * b.y;
    if (m.alphaMode == Material::Alpha::Blend) return alpha;
    return alpha >= m.alphaCutoff ? 1.0f : 0.0f;
}

bool mayHaveHoles(const Material& m, std::span<const Texture> textures, bool vertexAlpha) {
    if (m.alphaMode == Material::Alpha::Opaque) return false;
    if (m.baseAlpha < 1.0f || m.alphaCutoff > 1.0f || vertexAlpha) return true;
    if (!m.baseColorTexture) return false;
    // Exporters tend to mark every image with an alpha channel as BLEND.
    const auto& texels = textures[std::size_t(m.baseColorTexture.value)].rgba;
    for (std::size_t i = 3; i < texels.size(); i += 4) {
        if (texels[i] != 255) return true;
    }
    return false;
}

}  // namespace lacuna

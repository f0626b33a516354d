#include "libcore/scene/shading.h"

#include <algorithm>

#include "libcore/scene/texture.h"

namespace lacuna {

namespace {

/// Indices of refraction of all dielectric layers over a diffuse base that the materials may have.
std::vector<float> layerIndices(std::span<const Material> materials) {
    // A coloured texture can give any reflectance up to that of the factor. Tables at kSteps
    // intermediate values serve the layers below them, so that the base gets at most F0 / 8 too
    // little.
    constexpr int kSteps = 8;
    std::vector<float> indices;
    for (const Material& m : materials) {
        if (!mayHaveCoatedBase(m)) continue;
        for (int i = m.specularColorTexture ? 1 : kSteps; i <= kSteps; ++i) {
            indices.push_back(Bsdf::layerIor(m.ior, m.specularColor * (float(i) / kSteps)));
        }
    }
    return indices;
}

}  // namespace

Shading::Shading(const SceneDescription& description, std::span<const BakedMesh> meshes)
    : description_(description),
      tables_(std::make_unique<AlbedoTables>(layerIndices(description.materials))) {
    std::vector<bool> vertexColors(description.materials.size());
    for (const BakedMesh& m : meshes) {
        if (!m.colors.empty()) vertexColors[m.material] = true;
    }
    for (std::size_t i = 0; i < description.materials.size(); ++i) {
        prepared_.push_back(prepared(description.materials[i], vertexColors[i]));
    }
}

Bsdf Shading::bsdfAt(const SurfacePoint& point) const {
    const Prepared& common = prepared_[point.material];
    if (common.bsdf && !common.colorVaries) return common.bsdf->at(point.ng, point.ns);
    const Material& material = description_.materials[point.material];
    if (common.bsdf) {
        const Rgb color = baseColorAt(material, point.uv, point.uv1) * point.color;
        if (maxComponent(color) > 0.0f) return common.bsdf->at(point.ng, point.ns, color);
    }
    Bsdf::Parameters p = parametersAt(material, point.uv, point.uv1);
    p.baseColor *= point.color;
    p.anisotropy = length(point.grain);
    p.tangent = point.grain;
    p.clearcoatNormal = point.clearcoatNs;
    return Bsdf(p, point.ng, point.ns, *tables_);
}

Shading::Prepared Shading::prepared(const Material& m, bool vertexColors) const {
    if (std::any_of(kBsdfTextures.begin() + 1, kBsdfTextures.end(),
                    [&](TextureUse Material::*texture) { return bool(m.*texture); }) ||
        hasOwnDirections(m)) {
        return {};
    }
    Prepared out;
    out.colorVaries = m.baseColorTexture || vertexColors;
    Bsdf::Parameters p = parametersAt(m, {}, {});
    if (out.colorVaries) p.baseColor = Rgb(1.0f);
    out.bsdf = Bsdf(p, {}, {}, *tables_);
    return out;
}

Rgb Shading::baseColorAt(const Material& m, Vec2 uv, Vec2 uv1) const {
    if (!m.baseColorTexture) return m.baseColor;
    return m.baseColor * sampleTexture(description_.textures, m.baseColorTexture, uv, uv1).rgb;
}

Bsdf::Parameters Shading::parametersAt(const Material& m, Vec2 uv, Vec2 uv1) const {
    Bsdf::Parameters p;
    p.baseColor = baseColorAt(m, uv, uv1);
    p.metallic = m.metallic;
    p.roughness = m.roughness;
    p.specular = m.specular;
    p.specularColor = m.specularColor;
    p.ior = m.ior;
    p.transmission = m.transmission;
    p.thin = m.thin;
    p.pane = m.pane;
    p.clearcoat = m.clearcoat;
    p.clearcoatRoughness = m.clearcoatRoughness;
    p.sheenColor = m.sheenColor;
    p.sheenRoughness = m.sheenRoughness;
    p.diffuseTransmission = m.diffuseTransmission;
    p.diffuseTransmissionColor = m.diffuseTransmissionColor;
    p.without = m.without;
    const auto sample = [&](const TextureUse& use) {
        return sampleTexture(description_.textures, use, uv, uv1);
    };
    if (m.metallicRoughnessTexture) {
        const Rgb t = sample(m.metallicRoughnessTexture).rgb;
        p.roughness *= t.g;
        p.metallic *= t.b;
    }
    if (m.transmissionTexture) p.transmission *= sample(m.transmissionTexture).rgb.r;
    if (m.specularTexture) p.specular *= sample(m.specularTexture).alpha;
    if (m.specularColorTexture) p.specularColor *= sample(m.specularColorTexture).rgb;
    if (m.clearcoatTexture) p.clearcoat *= sample(m.clearcoatTexture).rgb.r;
    if (m.clearcoatRoughnessTexture) {
        p.clearcoatRoughness *= sample(m.clearcoatRoughnessTexture).rgb.g;
    }
    if (m.sheenColorTexture) p.sheenColor *= sample(m.sheenColorTexture).rgb;
    if (m.sheenRoughnessTexture) p.sheenRoughness *= sample(m.sheenRoughnessTexture).alpha;
    if (m.diffuseTransmissionTexture) {
        p.diffuseTransmission *= sample(m.diffuseTransmissionTexture).alpha;
    }
    if (m.diffuseTransmissionColorTexture) {
        p.diffuseTransmissionColor *= sample(m.diffuseTransmissionColorTexture).rgb;
    }
    return p;
}

}  // namespace lacuna

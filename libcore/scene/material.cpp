#include "libcore/scene/material.h"

#include <algorithm>

#include "libcore/material/bsdf.h"
#include "libcore/material/refraction.h"

namespace lacuna {

namespace {

/// Whether it may be neither all metal nor all glass.
bool mayHaveBase(const Material& m) {
    return (m.metallic < 1.0f || m.metallicRoughnessTexture) &&
           (m.transmission < 1.0f || m.transmissionTexture);
}

bool isRough(float roughness) {
    return roughness * roughness >= kMinAlpha;
}
/// Roughness across the grain, by the factors alone.
float roughnessOf(const Material& m) {
    return Bsdf::roughnessOf(m.roughness, m.anisotropy);
}
bool mayBeRough(const Material& m) {
    return isRough(roughnessOf(m));
}
/// The smallest roughness with its texture. Interpolation between texels may round it down a
/// little.
float leastOf(float roughness, const TextureUse& texture, float leastTexel) {
    return texture ? roughness * leastTexel * 0.9999f : roughness;
}
float leastRoughness(const Material& m) {
    return leastOf(m.roughness, m.metallicRoughnessTexture, m.leastRoughnessTexel);
}
bool mayBeSmooth(const Material& m) {
    const bool alwaysBrushed = m.anisotropy > 0.0f && !m.anisotropyTexture;
    return !alwaysBrushed && !isRough(leastRoughness(m));
}
bool mayHaveRoughClearcoat(const Material& m) {
    return m.clearcoat > 0.0f && isRough(m.clearcoatRoughness);
}
bool mayHaveSmoothClearcoat(const Material& m) {
    return m.clearcoat > 0.0f && !isRough(leastOf(m.clearcoatRoughness, m.clearcoatRoughnessTexture,
                                                  m.leastClearcoatRoughnessTexel));
}

bool mayBeGlossy(const Material& m) {
    return (mayReflect(m) && mayBeRough(m)) || mayHaveRoughClearcoat(m);
}
bool mayBeMirror(const Material& m) {
    return (mayReflect(m) && mayBeSmooth(m)) || mayHaveSmoothClearcoat(m);
}
bool mayRefractRoughly(const Material& m) {
    return mayTransmit(m) && !m.thin && refractsRoughly(roughnessOf(m), m.ior);
}
bool mayRefractSmoothly(const Material& m) {
    return mayTransmit(m) && !m.thin &&
           (mayBeSmooth(m) || !refractsRoughly(leastRoughness(m), m.ior));
}
bool mayPassRoughly(const Material& m) {
    return mayTransmit(m) && m.thin && mayBeRough(m);
}
bool mayPassSmoothly(const Material& m) {
    return mayTransmit(m) && m.thin && mayBeSmooth(m);
}

}  // namespace

bool usesSecondSet(const Material& m) {
    const auto second = [&](TextureUse Material::*texture) {
        return m.*texture && (m.*texture).secondSet;
    };
    return std::any_of(kBsdfTextures.begin(), kBsdfTextures.end(), second) ||
           std::any_of(kTurningTextures.begin(), kTurningTextures.end(), second) ||
           second(&Material::emissiveTexture);
}

bool hasOwnClearcoatNormal(const Material& m) {
    return m.clearcoat > 0.0f && (m.normalTexture || m.clearcoatNormalTexture);
}

bool hasOwnDirections(const Material& m) {
    return m.anisotropy > 0.0f || hasOwnClearcoatNormal(m);
}

bool mayBeDiffuse(const Material& m) {
    const bool stays = m.diffuseTransmission < 1.0f || m.diffuseTransmissionTexture;
    return !isBlack(m.baseColor) && stays && mayHaveBase(m);
}

bool mayTransmitDiffusely(const Material& m) {
    return m.diffuseTransmission > 0.0f && !isBlack(m.diffuseTransmissionColor) && mayHaveBase(m);
}

bool hasSheen(const Material& m) {
    return !isBlack(m.sheenColor);
}

bool mayReflect(const Material& m) {
    return m.metallic > 0.0f || mayHaveCoatedBase(m);
}

bool mayTransmit(const Material& m) {
    return m.transmission > 0.0f && (m.metallic < 1.0f || m.metallicRoughnessTexture);
}

bool stopsAllRays(const Material& m) {
    return !m.pane && m.alphaMode == Material::Alpha::Opaque;
}

bool mayBeSmoothGlass(const Material& m) {
    return (mayRefractSmoothly(m) && !m.without.has(LobeKind::SmoothRefraction)) ||
           (mayPassSmoothly(m) && !m.without.has(LobeKind::SmoothThinTransmission));
}

bool mayBeNarrowGlass(const Material& m) {
    const bool mayScatterWidely = mayBeDiffuse(m) || mayTransmitDiffusely(m) || hasSheen(m);
    return ((mayRefractRoughly(m) && !m.without.has(LobeKind::RoughRefraction)) ||
            (mayPassRoughly(m) && !m.without.has(LobeKind::RoughThinTransmission))) &&
           !m.metallicRoughnessTexture && Bsdf::isNarrow(m.roughness) && m.anisotropy == 0.0f &&
           !mayScatterWidely && !hasOwnClearcoatNormal(m);
}

bool mayBeClearGlass(const Material& m) {
    return (mayBeSmoothGlass(m) || mayBeNarrowGlass(m)) && stopsAllRays(m);
}

bool mayBeSpecular(const Material& m) {
    return (mayBeMirror(m) && !m.without.has(LobeKind::Mirror)) || mayBeSmoothGlass(m);
}

bool mayBePane(const Material& m) {
    return m.thin && !mayBeRough(m) && !m.metallicRoughnessTexture && m.metallic == 0.0f &&
           m.transmission == 1.0f && !m.transmissionTexture && m.clearcoat == 0.0f &&
           !hasSheen(m) && isBlack(m.emission) && !m.normalTexture &&
           !m.without.has(LobeKind::SmoothThinTransmission);
}

bool mayHaveCoatedBase(const Material& m) {
    return mayHaveBase(m) && m.specular > 0.0f && m.ior > 1.0f;
}

std::span<const LobeRow> lobeTable() {
    static constexpr LobeRow kRows[] = {
        {LobeKind::Diffuse, "diffuse", mayBeDiffuse},
        {LobeKind::Glossy, "glossy", mayBeGlossy},
        {LobeKind::Mirror, "mirror", mayBeMirror},
        {LobeKind::RoughRefraction, "rough_refraction", mayRefractRoughly},
        {LobeKind::SmoothRefraction, "smooth_refraction", mayRefractSmoothly},
        {LobeKind::RoughThinTransmission, "rough_thin_transmission", mayPassRoughly},
        {LobeKind::SmoothThinTransmission, "smooth_thin_transmission", mayPassSmoothly},
        {LobeKind::DiffuseTransmission, "diffuse_transmission", mayTransmitDiffusely},
        {LobeKind::Sheen, "sheen", hasSheen}};
    return kRows;
}

}  // namespace lacuna

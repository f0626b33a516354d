#include "libcore/scene/material.h"

#include <algorithm>

#include "libcore/material/bsdf.h"
#include "libcore/material/refraction.h"

namespace lacuna {

namespace {

/// Not all metal and not all glass.
bool mayHaveBase(const Material& m) {
    return (m.metallic < 1.0f || m.metallicRoughnessTexture) &&
           (m.transmission < 1.0f || m.transmissionTexture);
}

bool isRough(float roughness) {
    return roughness * roughness >= kMinAlpha;
}
bool mayBeRough(const Material& m) {
    return isRough(m.roughness);
}
bool mayBeSmooth(const Material& m) {
    return !mayBeRough(m) || m.metallicRoughnessTexture;
}
bool mayHaveRoughClearcoat(const Material& m) {
    return m.clearcoat > 0.0f && isRough(m.clearcoatRoughness);
}
bool mayHaveSmoothClearcoat(const Material& m) {
    return m.clearcoat > 0.0f && (!mayHaveRoughClearcoat(m) || m.clearcoatRoughnessTexture);
}

bool mayBeGlossy(const Material& m) {
    return (mayReflect(m) && mayBeRough(m)) || mayHaveRoughClearcoat(m);
}
bool mayBeMirror(const Material& m) {
    return (mayReflect(m) && mayBeSmooth(m)) || mayHaveSmoothClearcoat(m);
}
bool mayRefractRoughly(const Material& m) {
    return mayTransmit(m) && !m.thin && refractsRoughly(m.roughness, m.ior);
}
bool mayRefractSmoothly(const Material& m) {
    return mayTransmit(m) && !m.thin && (!mayRefractRoughly(m) || m.metallicRoughnessTexture);
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
           second(&Material::normalTexture) || second(&Material::emissiveTexture);
}

bool mayBeDiffuse(const Material& m) {
    return !isBlack(m.baseColor) && mayHaveBase(m);
}

bool mayReflect(const Material& m) {
    return m.metallic > 0.0f || mayHaveCoatedBase(m);
}

bool mayTransmit(const Material& m) {
    return m.transmission > 0.0f && (m.metallic < 1.0f || m.metallicRoughnessTexture);
}

bool mayBeSpecular(const Material& m) {
    return (mayBeMirror(m) && !m.without.has(LobeKind::Mirror)) ||
           (mayRefractSmoothly(m) && !m.without.has(LobeKind::SmoothRefraction)) ||
           (mayPassSmoothly(m) && !m.without.has(LobeKind::SmoothThinTransmission));
}

bool mayBePane(const Material& m) {
    return m.thin && !mayBeRough(m) && !m.metallicRoughnessTexture && m.metallic == 0.0f &&
           m.transmission == 1.0f && !m.transmissionTexture && m.clearcoat == 0.0f &&
           isBlack(m.emission) && !m.normalTexture &&
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
        {LobeKind::SmoothThinTransmission, "smooth_thin_transmission", mayPassSmoothly}};
    return kRows;
}

}  // namespace lacuna

// Construction of a Bsdf from material parameters, and its overall properties, such as its albedo.
// Values and densities: bsdf_evaluate.cpp; directions: bsdf_sample.cpp.
//
//     f = (1 - metallic) [ (1 - transmission) plastic + transmission glass ] + metallic metal
//
// under a clearcoat. (theory.md, "BSDFs")
#include "libcore/material/bsdf.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"
#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf_inl.h"
#include "libcore/material/fresnel.h"
#include "libcore/material/refraction.h"
#include "libcore/material/sheen.h"

namespace lacuna {
namespace {

/// Rough refraction spreads light by about alpha (ior - 1) radians. Below this spread, where the
/// half vector could not be computed either, glass counts as smooth. ior 1 is pure straight
/// transmission.
constexpr float kMinRefractionSpread = 1e-5f;
/// Far above the index of any dielectric; keeps 1 - F_avg representable.
constexpr float kMaxIor = 1e4f;
/// A path ends with at most 95 % probability: the inverse of the survival probability multiplies
/// its throughput.
constexpr float kMinSurvival = 0.05f;

float unit(float x) {
    return x > 0.0f ? std::min(x, 1.0f) : 0.0f;  // NaN becomes 0
}

Rgb unit(const Rgb& c) {
    return {unit(c.r), unit(c.g), unit(c.b)};
}

/// alpha of GGX; 0: smooth.
float alphaOf(float roughness) {
    const float alpha = unit(roughness) * unit(roughness);
    return alpha < kMinAlpha ? 0.0f : alpha;
}

float legalIor(float ior) {
    return ior > 1.0f ? std::min(ior, kMaxIor) : 1.0f;
}

/// Fresnel reflectance at normal incidence.
float normalReflectance(float ior) {
    const float r = (ior - 1.0f) / (ior + 1.0f);
    return r * r;
}

/// Reflectance of the coat at normal incidence, by channel.
Rgb coatReflectance(float ior, const Rgb& color) {
    const float f0 = normalReflectance(ior), most = normalReflectance(kMaxIor);
    const auto channel = [&](float c) { return c > 0.0f ? std::min(f0 * c, most) : 0.0f; };
    return {channel(color.r), channel(color.g), channel(color.b)};
}

}  // namespace

bool refractsRoughly(float roughness, float ior) {
    const float alpha = alphaOf(roughness);
    return alpha > 0.0f && alpha * (legalIor(ior) - 1.0f) >= kMinRefractionSpread;
}

float Bsdf::roughnessOf(float roughness, float anisotropy) {
    return anisotropy > 0.0f ? std::max(roughness, kMinBrushedRoughness) : roughness;
}

float Bsdf::layerIor(float ior, const Rgb& specularColor) {
    if (maxComponent(specularColor) == 1.0f) {
        return legalIor(ior);  // exactly, without rounding
    }
    const float r = std::sqrt(maxComponent(coatReflectance(legalIor(ior), specularColor)));
    return (1.0f + r) / (1.0f - r);
}

Bsdf::Bsdf(const Parameters& parameters, Vec3 ng, Vec3 ns, const AlbedoTables& tables)
    : ng_(ng),
      ns_(ns),
      baseColor_(unit(parameters.baseColor)),
      ior_(legalIor(parameters.ior)),
      coatIor_(layerIor(ior_, parameters.specularColor)),
      metal_(unit(parameters.metallic)),
      specular_(unit(parameters.specular)),
      clearcoat_(unit(parameters.clearcoat)),
      clearcoatAlpha_(clearcoat_ > 0.0f ? alphaOf(parameters.clearcoatRoughness) : 0.0f) {
    const float transmission = unit(parameters.transmission);
    plastic_ = (1.0f - metal_) * (1.0f - transmission);
    const Rgb coat = coatReflectance(ior_, parameters.specularColor);
    const float brightest = maxComponent(coat);
    tintLoss_ = (Rgb(brightest) - coat) * (1.0f / (1.0f - brightest));
    const float anisotropy = unit(parameters.anisotropy);
    const float roughness = roughnessOf(parameters.roughness, anisotropy);
    alpha_ = alphaOf(roughness);
    unsigned flags = 0;
    if (anisotropy > 0.0f) {
        alphaAlong_ = PackedUnit(alpha_ + (1.0f - alpha_) * anisotropy * anisotropy);
        const Vec3& tangent = parameters.tangent;
        tangent_ = PackedDirection(lengthSquared(tangent) > 0.0f ? tangent : Frame(ns).s);
        flags |= kBrushed;
    }

    const LobeSet& without = parameters.without;
    const auto reflects = [&](float alpha) {
        return !without.has(alpha > 0.0f ? LobeKind::Glossy : LobeKind::Mirror);
    };
    if (!reflects(clearcoatAlpha_)) clearcoat_ = clearcoatAlpha_ = 0.0f;
    const Vec3& coatNormal = parameters.clearcoatNormal;
    if (clearcoat_ > 0.0f && lengthSquared(coatNormal) > 0.0f && !(coatNormal == ns)) {
        coatNormal_ = PackedDirection(coatNormal);
        flags |= kOwnCoatNormal;
    }
    if (!reflects(alpha_)) specular_ = 0.0f;

    const bool coated = specular_ > 0.0f && coatIor_ > 1.0f;
    if (plastic_ > 0.0f) {
        diffuseThrough_ = unit(parameters.diffuseTransmission);
        const bool diffuse = !lacuna::isBlack(reflectedColor()) && !without.has(LobeKind::Diffuse);
        flags |= diffuse ? unsigned(kDiffuse) : 0u;
        flags |= coated ? unsigned(kCoat) : 0u;
        if (diffuseThrough_ > 0.0f) {
            throughColor_ = PackedColor(unit(parameters.diffuseTransmissionColor));
            const bool through =
                !lacuna::isBlack(throughColor()) && !without.has(LobeKind::DiffuseTransmission);
            flags |= through ? unsigned(kThrough) : 0u;
        }
    }
    const Rgb sheen = unit(parameters.sheenColor);
    if (!lacuna::isBlack(sheen) && !without.has(LobeKind::Sheen)) {
        sheenColor_ = PackedColor(sheen);
        sheenRoughness_ = PackedUnit(unit(parameters.sheenRoughness));
        flags |= lacuna::isBlack(sheenColor_.value()) ? 0u : unsigned(kSheen);
    }
    if (metal_ > 0.0f && reflects(alpha_)) {
        flags |= kMetal;
    }
    const bool thin = parameters.thin;
    const bool roughGlass = thin ? alpha_ > 0.0f : refractsRoughly(roughness, parameters.ior);
    const LobeKind glassKind =
        thin ? (roughGlass ? LobeKind::RoughThinTransmission : LobeKind::SmoothThinTransmission)
             : (roughGlass ? LobeKind::RoughRefraction : LobeKind::SmoothRefraction);
    if (transmission > 0.0f && glass() > 0.0f && !without.has(glassKind) &&
        !(lacuna::isBlack(baseColor_) && ior_ == 1.0f)) {
        flags |= kGlass;
        // Smooth glass of index 1 does not bend light. Whatever the normal, light passes it
        // straight, like a sheet.
        const bool straight = thin || (!roughGlass && ior_ == 1.0f);
        flags |= straight ? unsigned(kThin) : 0u;
        flags |= roughGlass ? unsigned(kRoughGlass) : 0u;
    }
    if ((flags & kLayers) != 0 && alpha_ > 0.0f) {
        flags |= kRoughLayers;
    }
    if ((flags & (kDiffuse | kThrough)) != 0) {
        flags_ = std::uint16_t(flags);
        float average = 0.0f;
        if (coated) {
            const AlbedoTable* exact = tables.find(coatIor_);
            table_ = alpha_ > 0.0f ? (exact ? exact : tables.covering(coatIor_)) : nullptr;
            if (table_) {
                const AlbedoTable::AlphaPosition position = AlbedoTable::positionOf(alpha_);
                alphaIndex_ = position.index;
                alphaFraction_ = position.fraction;
                average = table_->average(position);
            } else {
                average = exact ? exact->smoothAverage() : float(fresnelAverage(double(coatIor_)));
            }
        }
        const float open = openAverage(coated ? average : 0.0f);
        diffuseScale_ = open > 1e-6f ? plastic_ * kInvPi / open : 0.0f;
    }
    const int kinds =
        int((flags & kDiffuse) != 0) + int((flags & kLayers) != 0) + int((flags & kGlass) != 0);
    const bool oneLobe = kinds == 1 && !(clearcoat_ > 0.0f) && (flags & (kThrough | kSheen)) == 0;
    flags_ = std::uint16_t(flags | (oneLobe ? unsigned(kOneLobe) : 0u));
    isPane_ = parameters.pane && thin && !roughGlass && oneLobe && (flags & kGlass) != 0;
}

Bsdf Bsdf::at(Vec3 ng, Vec3 ns, const Rgb& baseColor) const {
    Bsdf b = at(ng, ns);
    b.baseColor_ = unit(baseColor);
    return b;
}

/// Cosine-weighted mean of the share that the coats about ns leave to the diffuse base.
float Bsdf::openAverage(float coatAverage) const {
    if (!(clearcoat_ > 0.0f) || has(kOwnCoatNormal)) {
        return 1.0f - specular_ * coatAverage;
    }
    // Gauss-Legendre in mu: the positive nodes on [-1, 1] and their weights.
    constexpr float kNode[] = {0.18343464f, 0.52553241f, 0.79666648f, 0.96028986f};
    constexpr float kWeight[] = {0.36268378f, 0.31370665f, 0.22238103f, 0.10122854f};
    const bool coated = coatAverage > 0.0f;
    float sum = 0.0f;
    for (int i = 0; i < 4; ++i) {
        for (const float side : {-1.0f, 1.0f}) {
            const float mu = 0.5f + 0.5f * side * kNode[i];
            const float coat = coated ? 1.0f - specular_ * coatAlbedo(mu) : 1.0f;
            sum += kWeight[i] * mu * coat * (1.0f - clearcoat_ * clearcoatAlbedo(mu));
        }
    }
    return sum;
}

float Bsdf::passing(const Vec3& direction) const {
    if (!isPane_) return 0.0f;
    const float cosine = std::abs(dot(normalize(direction), ng_));
    if (!(cosine >= kMinCosine)) return 0.0f;
    return (1.0f - fresnelDielectric(std::min(1.0f, cosine), ior_)) * minComponent(baseColor_);
}

float Bsdf::survivalAlbedo() const {
    const float color = maxComponent(baseColor_);
    const float dark = 1.0f - color;
    const float diffuse = maxComponent(reflectedColor()) + maxComponent(throughColor());
    float albedo = metal_ * (color + dark * (1.0f / 21.0f)) + plastic_ * diffuse;
    // Hemispherical mean of the reflectance.
    const auto average = [](float ior) {
        const float f0 = normalReflectance(ior);
        return f0 + (1.0f - f0) * (1.0f / 21.0f);
    };
    if (has(kCoat | kGlass)) {
        // For glass, the mean seen from inside, which is larger because of total internal
        // reflection: 1 - (1 - F_avg) / ior^2.
        albedo += has(kCoat) ? plastic_ * (1.0f - diffuse) * specular_ * average(coatIor_) : 0.0f;
        const float outside = average(ior_);
        const float inside = has(kThin) ? outside : 1.0f - (1.0f - outside) / (ior_ * ior_);
        albedo += has(kGlass) ? glass() * (color + dark * inside) : 0.0f;
    }
    if (has(kSheen)) {
        albedo += (1.0f - albedo) * maxComponent(sheenColor_.value()) * meanSheen();
    }
    if (clearcoat_ > 0.0f) {
        albedo += (1.0f - albedo) * clearcoat_ * average(kClearcoatIor);
    }
    return std::clamp(albedo, kMinSurvival, 1.0f);
}

Rgb Bsdf::layerAlbedo() const {
    const float f0 = has(kCoat) ? normalReflectance(coatIor_) : 0.0f;
    const Rgb coat = has(kCoat) ? (Rgb(f0) - tintLoss_ * (1.0f - f0)) * specular_ : Rgb{};
    const Rgb diffuse = reflectedColor() + throughColor();
    Rgb under =
        plastic_ * (diffuse * (1.0f - specular_ * f0) + coat) + (1.0f - plastic_) * baseColor_;
    if (has(kSheen)) {
        const Rgb sheen = sheenColor_.value() * meanSheen();
        under = under * (1.0f - maxComponent(sheen)) + sheen;
    }
    const float clear = clearcoat_ * normalReflectance(kClearcoatIor);
    return under * (1.0f - clear) + Rgb(clear);
}

}  // namespace lacuna

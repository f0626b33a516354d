// The material: what a Bsdf is made of, what its lobes are chosen with, and what the integrators
// ask about it as a whole. Values and densities: bsdf_evaluate.cpp; directions: bsdf_sample.cpp.
//
//     f = (1 - metallic) [ (1 - transmission) plastic + transmission glass ] + metallic metal
#include "libcore/material/bsdf.h"

#include <algorithm>

#include "libcore/base/sampling.h"
#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf_inl.h"
#include "libcore/material/fresnel.h"

namespace lacuna {
namespace {

/// Rough refraction spreads light by about alpha (ior - 1) radians. Below this spread (where the
/// half vector could not be computed either) glass counts as smooth: ior 1 is pure straight
/// transmission.
constexpr float kMinRefractionSpread = 1e-5f;
/// Far beyond any dielectric; keeps 1 - F_avg representable.
constexpr float kMaxIor = 1e4f;
/// A path is never ended with more than 95 % (the inverse multiplies what survives).
constexpr float kMinSurvival = 0.05f;

float unit(float x) {
    return x > 0.0f ? std::min(x, 1.0f) : 0.0f;  // NaN becomes 0
}

}  // namespace

Bsdf::Bsdf(const Parameters& parameters, Vec3 ng, Vec3 ns, const AlbedoTables& tables)
    : ng_(ng),
      ns_(ns),
      baseColor_(unit(parameters.baseColor.r), unit(parameters.baseColor.g),
                 unit(parameters.baseColor.b)),
      ior_(parameters.ior > 1.0f ? std::min(parameters.ior, kMaxIor) : 1.0f),
      metal_(unit(parameters.metallic)),
      specular_(unit(parameters.specular)) {
    const float transmission = unit(parameters.transmission);
    plastic_ = (1.0f - metal_) * (1.0f - transmission);
    glass_ = (1.0f - metal_) * transmission;
    const float roughness = unit(parameters.roughness);
    alpha_ = roughness * roughness < kMinAlpha ? 0.0f : roughness * roughness;

    unsigned flags = 0;
    const bool coated = specular_ > 0.0f && ior_ > 1.0f;
    if (plastic_ > 0.0f) {
        flags |= lacuna::isBlack(baseColor_) ? 0u : unsigned(kDiffuse);
        flags |= coated ? unsigned(kCoat) : 0u;
    }
    if (metal_ > 0.0f) {
        flags |= kMetal;
    }
    if (glass_ > 0.0f && !(lacuna::isBlack(baseColor_) && ior_ == 1.0f)) {
        flags |= kGlass;
        flags |= parameters.thin ? unsigned(kThin) : 0u;
        if (alpha_ > 0.0f && (parameters.thin || alpha_ * (ior_ - 1.0f) >= kMinRefractionSpread)) {
            flags |= kRoughGlass;
        }
    }
    if ((flags & kLayers) != 0 && alpha_ > 0.0f) {
        flags |= kRoughLayers;
    }
    if ((flags & kDiffuse) != 0) {
        float average = 0.0f;
        if (coated) {
            const AlbedoTable* exact = tables.find(ior_);
            table_ = alpha_ > 0.0f ? (exact ? exact : tables.nearest(ior_)) : nullptr;
            if (table_) {
                const AlbedoTable::Row row = AlbedoTable::row(alpha_);
                rowIndex_ = row.index;
                rowFraction_ = row.fraction;
                average = table_->average(row);
            } else {
                average = exact ? exact->smoothAverage() : float(fresnelAverage(double(ior_)));
            }
        }
        const float open = 1.0f - specular_ * average;
        diffuseScale_ = open > 1e-6f ? plastic_ * kInvPi / open : 0.0f;
        diffuseChoice_ = plastic_ * mean(baseColor_);
    }
    const int kinds =
        int((flags & kDiffuse) != 0) + int((flags & kLayers) != 0) + int((flags & kGlass) != 0);
    flags_ = std::uint8_t(flags | (kinds == 1 ? unsigned(kOneLobe) : 0u));
}

float Bsdf::survivalAlbedo() const {
    const float color = maxComponent(baseColor_);
    const float dark = 1.0f - color;
    float albedo = metal_ * (color + dark * (1.0f / 21.0f)) + plastic_ * color;
    if (has(kCoat | kGlass)) {
        // Hemispherical means of Fresnel's reflectance; glass from its inside, where total internal
        // reflection makes it largest: 1 - (1 - F_avg) / ior^2.
        const float f0 = (ior_ - 1.0f) * (ior_ - 1.0f) / ((ior_ + 1.0f) * (ior_ + 1.0f));
        const float average = f0 + (1.0f - f0) * (1.0f / 21.0f);
        albedo += has(kCoat) ? plastic_ * dark * specular_ * average : 0.0f;
        const float inside = has(kThin) ? average : 1.0f - (1.0f - average) / (ior_ * ior_);
        albedo += has(kGlass) ? glass_ * (color + dark * inside) : 0.0f;
    }
    return std::clamp(albedo, kMinSurvival, 1.0f);
}

Rgb Bsdf::layerAlbedo() const {
    const float f0 = (ior_ - 1.0f) * (ior_ - 1.0f) / ((ior_ + 1.0f) * (ior_ + 1.0f));
    const float coat = has(kCoat) ? specular_ * f0 : 0.0f;
    return plastic_ * (baseColor_ * (1.0f - coat) + Rgb(coat)) + (glass_ + metal_) * baseColor_;
}

}  // namespace lacuna

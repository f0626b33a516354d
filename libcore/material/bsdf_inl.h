// Shared by the Bsdf's source files only: small pieces of every evaluation and of every sample.
#pragma once

#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"
#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/fresnel.h"

namespace lacuna {

/// False where the pair scatters nothing: grazing, or on different sides of ng and ns.
inline bool Bsdf::makePair(Vec3 toEye, Vec3 toLight, Pair& pair) const {
    const float eyeG = dot(toEye, ng_);
    const float lightG = dot(toLight, ng_);
    pair.eye = dot(toEye, ns_);
    pair.light = dot(toLight, ns_);
    pair.adjoint = pair.light / lightG;
    // Bitwise: one branch. NaN fails every comparison.
    return (std::abs(eyeG) >= kMinCosine) & (std::abs(lightG) >= kMinCosine) &
           (std::abs(pair.eye) >= kMinCosine) & (std::abs(pair.light) >= kMinCosine) &
           (eyeG * pair.eye > 0.0f) & (lightG * pair.light > 0.0f);
}

/// E(mu) of the dielectric layer with specular factor 1.
inline float Bsdf::coatAlbedo(float mu) const {
    return table_ ? table_->directional({rowIndex_, rowFraction_}, mu)
                  : fresnelDielectric(mu, ior_);
}

/// Lobe probabilities: the lobes' albedos, channels averaged, as far as they are known without
/// effort. A function of the material and of the one known direction: sampling and density use this
/// and nothing else.
inline Bsdf::Choice Bsdf::choose(float mu) const {
    Choice c;
    if ((flags_ & (kDiffuse | kCoat)) == (kDiffuse | kCoat)) {
        c.open = 1.0f - specular_ * coatAlbedo(mu);
    } else if (has(kOneLobe)) {
        c.diffuse = has(kDiffuse) ? 1.0f : 0.0f;
        c.layers = has(kLayers) ? 1.0f : 0.0f;
        c.glass = has(kGlass) ? 1.0f : 0.0f;
        return c;
    } else if (has(kCoat)) {
        c.open = 1.0f - specular_ * fresnelDielectric(mu, ior_);
    }
    c.diffuse = diffuseChoice_ * c.open;
    if (has(kCoat)) {
        c.layers = plastic_ * (1.0f - c.open);
    }
    if (has(kMetal)) {
        // A floor: dark metal still reflects where the half vector is grazing.
        const float f0 = mean(baseColor_);
        c.layers += metal_ * std::max(0.02f, f0 + (1.0f - f0) * schlickWeight(mu));
    }
    if (has(kGlass)) {
        c.glass = glass_ * std::max(0.1f, mean(baseColor_));
    }
    const float sum = c.diffuse + c.layers + c.glass;
    const float inverse = sum > 0.0f ? 1.0f / sum : 0.0f;
    c.diffuse *= inverse;
    c.layers *= inverse;
    c.glass *= inverse;
    return c;
}

/// Coat and metal together; `coatFresnel` is the exact Fresnel reflectance seen from outside.
inline Rgb Bsdf::layersReflectance(float cosine, float coatFresnel) const {
    Rgb r(has(kCoat) ? plastic_ * specular_ * coatFresnel : 0.0f);
    if (has(kMetal)) {
        r += metal_ * schlick(baseColor_, cosine);
    }
    return r;
}

}  // namespace lacuna

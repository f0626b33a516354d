// Small inline functions that the Bsdf's source files share, used in evaluation and sampling.
// (theory.md, "Panes", "BSDFs")
#pragma once

#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"
#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/fresnel.h"
#include "libcore/material/sheen.h"

namespace lacuna {

/// E(mu) of the dielectric layer's brightest channel with specular factor 1.
inline float Bsdf::coatAlbedo(float mu) const {
    return table_ ? table_->directional({alphaIndex_, alphaFraction_}, mu)
                  : fresnelDielectric(mu, coatIor_);
}

/// E(mu) of the clearcoat with factor 1.
inline float Bsdf::clearcoatAlbedo(float mu) const {
    return clearcoatAlpha_ > 0.0f
               ? clearcoatTable().directional(AlbedoTable::positionOf(clearcoatAlpha_), mu)
               : fresnelDielectric(mu, kClearcoatIor);
}

/// E(mu) of a white sheen.
inline float Bsdf::sheenAlbedo(float mu) const {
    return sheenTable().directional(sheenRoughness_.value(), mu);
}

/// Upper estimate of the cosine-weighted mean of E.
inline float Bsdf::meanSheen() const {
    return std::min(1.0f, sheenAlbedo(0.5f));
}

/// w: weight of the lobes about ng for an eye (bsdf.h). With m the cosine between ng and the eye's
/// mirror direction about ns, it is 1 - 4 m / |toEye . ng|, clamped.
inline float Bsdf::eyeShare(float eyeS, float eyeG) const {
    // Exactly 1 where the normals are equal.
    const float cosine = 1.0f - 0.5f * lengthSquared(ns_ - ng_);
    return std::clamp(5.0f - 8.0f * cosine * (eyeS / eyeG), 0.0f, 1.0f);
}

/// The probability that a light walk picks ng. It is 1 where ns sees no light. It is half of w for
/// the eye in the mirror direction about ng, if that eye sees lobes about ng. Elsewhere it is small
/// but positive: there, the eyes that see such lobes fill a share of directions of about the square
/// of the angle between the normals. If the walk picked ng as rarely as that, its throughput would
/// contain the inverse.
inline float Bsdf::lightShare(float lightS, float lightG) const {
    if (!(lightS * lightG > 0.0f)) return 1.0f;
    const float tilt2 = lengthSquared(ns_ - ng_);
    const float mirroredS = (2.0f - tilt2) * lightG - lightS;
    return std::max(std::min(0.125f, 0.5f * std::sqrt(tilt2)), 0.5f * eyeShare(mirroredS, lightG));
}

/// Lobe probabilities: proportional to the lobes' albedos, averaged over channels, as far as they
/// are known cheaply. They depend on the material and the one known direction. Sampling and
/// densities use no other probabilities.
inline Bsdf::Choice Bsdf::choose(float mu) const {
    Choice c;
    if (has(kDiffuse | kThrough) && has(kCoat)) {
        c.open = 1.0f - specular_ * coatAlbedo(mu);
    } else if (has(kOneLobe)) {
        c.diffuse = has(kDiffuse) ? 1.0f : 0.0f;
        c.layers = has(kLayers) ? 1.0f : 0.0f;
        c.glass = has(kGlass) ? 1.0f : 0.0f;
        return c;
    } else if (has(kCoat)) {
        c.open = 1.0f - specular_ * fresnelDielectric(mu, coatIor_);
    }
    if (has(kDiffuse)) {
        c.diffuse = plastic_ * mean(baseColor_) * c.open * (1.0f - diffuseThrough_);
    }
    if (has(kThrough)) {
        c.through = plastic_ * mean(throughColor()) * c.open;
    }
    if (has(kCoat)) {
        c.layers = plastic_ * (1.0f - c.open);
    }
    if (has(kMetal)) {
        // A lower bound: dark metal still reflects at grazing half vectors.
        const float f0 = mean(baseColor_);
        c.layers += metal_ * std::max(0.02f, f0 + (1.0f - f0) * schlickWeight(mu));
    }
    if (has(kGlass)) {
        c.glass = glass() * std::max(0.1f, mean(baseColor_));
    }
    const auto scale = [&c](float by) {
        c.diffuse *= by;
        c.through *= by;
        c.layers *= by;
        c.glass *= by;
    };
    if (has(kSheen)) {
        const Rgb color = sheenColor_.value();
        c.sheen = sheenAlbedo(mu);
        c.bare = 1.0f - maxComponent(color) * std::min(1.0f, c.sheen);
        scale(c.bare);
        c.diffuse += mean(color) * std::min(1.0f, c.sheen);
    }
    if (clearcoat_ > 0.0f) {
        c.clearcoat = clearcoat_ * clearcoatAlbedo(mu);
        c.under = 1.0f - c.clearcoat;
        scale(c.under);
    }
    const float sum = c.diffuse + c.layers + c.glass + c.clearcoat + c.through;
    const float inverse = sum > 0.0f ? 1.0f / sum : 0.0f;
    c.clearcoat *= inverse;
    scale(inverse);
    return c;
}

/// For a pane, the rays that stop are reflected by Fresnel's law or transmitted with the part of the colour that
/// exceeds its smallest channel.
inline Bsdf::Interface Bsdf::interfaceAt(float cosine, float relativeIndex) const {
    const float fresnel = fresnelDielectric(cosine, relativeIndex);
    if (!isPane_) return {fresnel, Rgb{}, fresnel};
    const float grey = minComponent(baseColor_);
    const float stopping = 1.0f - (1.0f - fresnel) * grey;
    if (!(stopping > 0.0f)) return {0.0f, Rgb{}, 0.0f};
    const float reflected = fresnel / stopping, open = (1.0f - fresnel) / stopping;
    const Rgb transmitted = (baseColor_ - Rgb(grey)) * open;
    const float sum = reflected + maxComponent(transmitted);
    return {reflected, transmitted, sum > 0.0f ? reflected / sum : 0.0f};
}

/// Reflectance of coat and metal together, seen from outside. The coat is tinted at normal
/// incidence and becomes white towards grazing angles, as in Fresnel's law.
inline Rgb Bsdf::layersReflectance(float cosine) const {
    Rgb r;
    if (has(kCoat)) {
        const float f = fresnelDielectric(cosine, coatIor_);
        const Rgb tinted = Rgb(f) - tintLoss_ * (1.0f - f);
        // Negative only for indices above 3.7, whose reflectance dips before it rises.
        r = Rgb(std::max(0.0f, tinted.r), std::max(0.0f, tinted.g), std::max(0.0f, tinted.b)) *
            (plastic_ * specular_);
    }
    if (has(kMetal)) {
        r += metal_ * schlick(baseColor_, cosine);
    }
    return r;
}

}  // namespace lacuna

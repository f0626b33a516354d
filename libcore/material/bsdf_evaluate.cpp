// Values and densities. With e = toEye, l = toLight, c = |cos| about ns,
// S(c) = c sqrt(1 + a^2 tan^2):
//
//     G1 / c = 2 / (c + S),   G2 / (c_e c_l) = 2 / (S_e c_l + S_l c_e)        (microfacet.h)
//     K = D(h) |dw_h / dw_to| |v.h| without the index of the side `to` lies on:
//         reflection  D / 4,   refraction  D |e.h| |l.h| / |H|^2,   H = eta_e e + eta_l l
//     f_ns   = R eta_eye^2 K G2 / (c_e c_l)             [Walter07 eq 20, 21]
//     pdfW   = pmf eta_to^2 K G1(from) / c_from         [Heitz18; Walter07 eq 14, 17]
//
// R: reflectance or transmittance at h; pmf: probability of the lobe given `from`, times F or 1 - F
// for glass; eta: 1 for reflections. Dropping K and the G's common limit leaves the delta events'
// formulas.
#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/bsdf_inl.h"
#include "libcore/material/fresnel.h"
#include "libcore/material/microfacet.h"

namespace lacuna {

namespace {

/// A GGX lobe at the half vector of two directions on one side (or one of them mirrored there).
struct Lobe {
    float cosine;          ///< e.h = l.h
    float k;               ///< D / 4
    float g2;              ///< G2 / (c_e c_l)
    float g1Eye, g1Light;  ///< G1 / c_e, G1 / c_l
};

/// From H = e + l, of any length, and both |cosines| about ns.
inline Lobe lobeOf(Vec3 h, Vec3 ns, float ce, float cl, float alpha) {
    const float hn = ce + cl;
    const float cross2 = lengthSquared(cross(h, ns));
    const float se = ggx::smithS(ce, alpha * alpha);
    const float sl = ggx::smithS(cl, alpha * alpha);
    return {std::min(1.0f, 0.5f * std::sqrt(hn * hn + cross2)),  // |H| / 2
            0.25f * ggx::distribution(alpha, hn, cross2), ggx::g2OverCosines(ce, se, cl, sl),
            ggx::g1OverCosine(ce, se), ggx::g1OverCosine(cl, sl)};
}

}  // namespace

// One result variable per function, filled in place: a copy of it would wait for its parts' stores.
BsdfEvaluation Bsdf::evaluateLobes(const Vec3& toEye, const Vec3& toLight) const {
    BsdfEvaluation out;
    Pair pair;
    if (!connectable() || !makePair(toEye, toLight, pair)) {
        return out;
    }
    if (!pair.reflects()) {
        if (has(kRoughGlass)) {
            if (has(kThin)) {
                addRoughThinTransmission(toEye, toLight, pair, out);
            } else {
                addRoughRefraction(toEye, toLight, pair, out);
            }
        }
        return out;
    }
    const Choice eye = choose(pair.eyeAbs());
    const Choice light = choose(pair.lightAbs());
    if (has(kDiffuse)) {
        out.f = baseColor_ *
                (diffuseScale_ * eye.open * eye.under * light.open * light.under * pair.adjoint);
        out.pdfWToLight = eye.diffuse * pair.lightAbs() * kInvPi;
        out.pdfWToEye = light.diffuse * pair.eyeAbs() * kInvPi;
    }
    if (has(kRoughLayers | kRoughGlass)) {
        addRoughReflection(toEye, toLight, pair, eye, light, out);
    }
    if (clearcoatAlpha_ > 0.0f) {
        addRoughClearcoat(toEye, toLight, pair, eye, light, out);
    }
    return out;
}

void Bsdf::addRoughReflection(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                              const Choice& eye, const Choice& light, BsdfEvaluation& out) const {
    const Lobe lobe = lobeOf(toEye + toLight, ns_, pair.eyeAbs(), pair.lightAbs(), alpha_);

    Rgb reflectance(0.0f);
    float pmfEye = 0, pmfLight = 0;  // given toEye, given toLight
    if (has(kRoughLayers)) {
        reflectance = layersReflectance(lobe.cosine);
        pmfEye = eye.layers;
        pmfLight = light.layers;
    }
    if (has(kRoughGlass)) {
        const bool front = pair.eye > 0.0f;
        const float inner = fresnelDielectric(lobe.cosine, relativeIndex(front));
        reflectance += Rgb(glass() * inner);
        pmfEye += eye.glass * inner;
        pmfLight += light.glass * inner;
    }
    out.f += reflectance * (through(eye, light) * lobe.k * lobe.g2 * pair.adjoint);
    out.pdfWToLight += pmfEye * lobe.k * lobe.g1Eye;
    out.pdfWToEye += pmfLight * lobe.k * lobe.g1Light;
}

void Bsdf::addRoughClearcoat(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                             const Choice& eye, const Choice& light, BsdfEvaluation& out) const {
    const Lobe lobe = lobeOf(toEye + toLight, ns_, pair.eyeAbs(), pair.lightAbs(), clearcoatAlpha_);
    const float reflectance = clearcoat_ * fresnelDielectric(lobe.cosine, kClearcoatIor);
    out.f += Rgb(reflectance * lobe.k * lobe.g2 * pair.adjoint);
    out.pdfWToLight += eye.clearcoat * lobe.k * lobe.g1Eye;
    out.pdfWToEye += light.clearcoat * lobe.k * lobe.g1Light;
}

// The reflection lobe mirrored through the surface [glTF 2.0, KHR_materials_transmission].
// Mirroring toLight about ns leaves its tangential part, hence H x n, as it is.
void Bsdf::addRoughThinTransmission(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                                    BsdfEvaluation& out) const {
    const Lobe lobe = lobeOf(toEye + toLight, ns_, pair.eyeAbs(), pair.lightAbs(), alpha_);
    const float transmit = 1.0f - fresnelDielectric(lobe.cosine, ior_);
    const Choice eye = choose(pair.eyeAbs()), light = choose(pair.lightAbs());
    out.f =
        baseColor_ * (glass() * transmit * through(eye, light) * lobe.k * lobe.g2 * pair.adjoint);
    out.pdfWToLight = eye.glass * transmit * lobe.k * lobe.g1Eye;
    out.pdfWToEye = light.glass * transmit * lobe.k * lobe.g1Light;
}

void Bsdf::addRoughRefraction(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                              BsdfEvaluation& out) const {
    const bool eyeOutside = pair.eye > 0.0f;
    const Vec3 o = eyeOutside ? toEye : toLight;
    const Vec3 i = eyeOutside ? toLight : toEye;
    const float ce = pair.eyeAbs();
    const float cl = pair.lightAbs();
    // H = -(o + ior i) lies on the side of the lower index, the outside [Walter07 eq 16].
    const float hn = ior_ * (eyeOutside ? cl : ce) - (eyeOutside ? ce : cl);
    const float cosineIO = dot(o, i);
    const float oh = -(1.0f + ior_ * cosineIO);  // o.H
    const float ih = -(cosineIO + ior_);         // i.H
    if (!(hn > 0.0f && oh > 0.0f && ih < 0.0f)) {
        return;  // no microfacet refracts one into the other
    }
    const float cross2 = lengthSquared(cross(o + i * ior_, ns_));
    const float h2 = hn * hn + cross2;
    const float cosine = std::min(1.0f, oh / std::sqrt(h2));
    // |eta_o o.h + eta_i i.h| = |H|: K = D |o.h| |i.h| / |H|^2 = D oh |ih| / |H|^4.
    const float k = ggx::distribution(alpha_, hn, cross2) * oh * -ih / (h2 * h2);
    const float se = ggx::smithS(ce, alpha_ * alpha_);
    const float sl = ggx::smithS(cl, alpha_ * alpha_);
    const float transmit = 1.0f - fresnelDielectric(cosine, ior_);
    const float etaEye = indexOn(eyeOutside);
    const float etaLight = indexOn(!eyeOutside);

    const Choice eye = choose(ce), light = choose(cl);
    out.f = baseColor_ * (glass() * transmit * through(eye, light) * etaEye * etaEye * k *
                          ggx::g2OverCosines(ce, se, cl, sl) * pair.adjoint);
    out.pdfWToLight = eye.glass * transmit * etaLight * etaLight * k * ggx::g1OverCosine(ce, se);
    out.pdfWToEye = light.glass * transmit * etaEye * etaEye * k * ggx::g1OverCosine(cl, sl);
}

BsdfEvaluation Bsdf::evaluateDelta(const Vec3& toEye, const Vec3& toLight,
                                   ScatterEvent event) const {
    BsdfEvaluation out;
    Pair pair;
    if (event == ScatterEvent::Smooth || !makePair(toEye, toLight, pair) ||
        pair.reflects() != (event == ScatterEvent::DeltaReflection)) {
        return out;
    }
    const bool deltaLayers = has(kLayers) && !has(kRoughLayers);
    const bool deltaGlass = has(kGlass) && !has(kRoughGlass);
    const bool deltaClearcoat = clearcoat_ > 0.0f && !(clearcoatAlpha_ > 0.0f);
    const float ce = pair.eyeAbs();
    const float cl = pair.lightAbs();
    const bool front = pair.eye > 0.0f;
    const Choice eye = choose(ce);
    const Choice light = choose(cl);
    if (event == ScatterEvent::DeltaTransmission) {
        if (!deltaGlass) {
            return out;
        }
        // From the outside, where there is no total internal reflection; thin: both sides are.
        const float transmit = 1.0f - fresnelDielectric(front || has(kThin) ? ce : cl, ior_);
        const float etaEye = indexOn(front);
        const float etaLight = indexOn(!front);
        out.f = baseColor_ *
                (glass() * transmit * through(eye, light) * etaEye * etaEye * pair.adjoint);
        out.pdfWToLight = eye.glass * transmit * etaLight * etaLight * cl;
        out.pdfWToEye = light.glass * transmit * etaEye * etaEye * ce;
        return out;
    }
    if (!deltaLayers && !deltaGlass && !deltaClearcoat) {
        return out;
    }
    Rgb reflectance(0.0f);
    float pmfEye = 0, pmfLight = 0;
    if (deltaLayers) {
        reflectance = layersReflectance(ce);
        pmfEye = eye.layers;
        pmfLight = light.layers;
    }
    if (deltaGlass) {
        const float inner = fresnelDielectric(ce, relativeIndex(front));
        reflectance += Rgb(glass() * inner);
        pmfEye += eye.glass * inner;
        pmfLight += light.glass * inner;
    }
    reflectance *= through(eye, light);
    if (deltaClearcoat) {
        reflectance += Rgb(clearcoat_ * fresnelDielectric(ce, kClearcoatIor));
        pmfEye += eye.clearcoat;
        pmfLight += light.clearcoat;
    }
    out.f = reflectance * pair.adjoint;
    out.pdfWToLight = pmfEye * cl;
    out.pdfWToEye = pmfLight * ce;
    return out;
}

}  // namespace lacuna

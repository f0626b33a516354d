// Values and densities. With e = toEye, l = toLight, c = |cos| about the normal n,
// S(c) = c sqrt(1 + a^2 tan^2):
//
//     G1 / c = 2 / (c + S),   G2 / (c_e c_l) = 2 / (S_e c_l + S_l c_e)        (microfacet.h)
//     K = D(h) |dw_h / dw_to| |v.h| without the index on the side of `to`:
//         reflection  D / 4,   refraction  D |e.h| |l.h| / |H|^2,   H = eta_e e + eta_l l
//     f_n    = R eta_eye^2 K G2 / (c_e c_l)             [Walter07 eq 20, 21]
//     pdfW   = pmf eta_to^2 K G1(from) / c_from         [Heitz18; Walter07 eq 14, 17]
//
// R: reflectance or transmittance at h; pmf: probability of the lobe given `from`, times F or 1 - F
// for glass; eta: 1 for reflections. The formulas of delta events follow by dropping K and the
// common limit of the G terms. (theory.md, "BSDFs")
#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/bsdf_inl.h"
#include "libcore/material/fresnel.h"
#include "libcore/material/microfacet.h"

namespace lacuna {

/// The terms that depend on roughness, for a half vector and both directions.
struct Bsdf::Facets {
    float d;       ///< D(h)
    float se, sl;  ///< S of e and l

    static Facets isotropic(Vec3 h, float hn, Vec3 n, float ce, float cl, float alpha) {
        return {ggx::distribution(alpha, hn, lengthSquared(cross(h, n))),
                ggx::smithS(ce, alpha * alpha), ggx::smithS(cl, alpha * alpha)};
    }
};

/// A GGX lobe at the half vector of two directions on one side (one of them may have been mirrored
/// to it).
struct Bsdf::Lobe {
    float cosine;          ///< e.h = l.h
    float k;               ///< D / 4
    float g2;              ///< G2 / (c_e c_l)
    float g1Eye, g1Light;  ///< G1 / c_e, G1 / c_l

    /// From H = e + l, of any length, and both |cosines| about n.
    Lobe(Vec3 h, Vec3 n, float ce, float cl, const Facets& facets)
        : cosine(std::min(1.0f, 0.5f * std::sqrt((ce + cl) * (ce + cl) +
                                                 lengthSquared(cross(h, n))))),  // |H| / 2
          k(0.25f * facets.d),
          g2(ggx::g2OverCosines(ce, facets.se, cl, facets.sl)),
          g1Eye(ggx::g1OverCosine(ce, facets.se)),
          g1Light(ggx::g1OverCosine(cl, facets.sl)) {}
};

ggx::Grain Bsdf::grainAbout(const Vec3& n) const {
    const Vec3 tangent = tangent_.value();
    const Vec3 flat = tangent - n * dot(tangent, n);
    const Vec3 t = lengthSquared(flat) > 1e-6f ? normalize(flat) : Frame(n).s;
    return {t, cross(n, t), alphaAlong_.value(), alpha_};
}

/// Terms of layers and glass, for H of any length. For transmission through a sheet, the mirrored direction differs
/// from the given one only along n, which does not affect the grain's terms.
inline Bsdf::Facets Bsdf::facets(Vec3 h, float hn, const Vec3& toEye, const Vec3& toLight,
                                 const Pair& pair) const {
    const float ce = pair.eyeAbs(), cl = pair.lightAbs();
    if (!has(kBrushed)) return Facets::isotropic(h, hn, pair.n, ce, cl, alpha_);
    const ggx::Grain grain = grainAbout(pair.n);
    return {ggx::distribution(h, hn, grain), ggx::smithS(ce, toEye, grain),
            ggx::smithS(cl, toLight, grain)};
}

inline Bsdf::Lobe Bsdf::baseLobe(const Vec3& toEye, const Vec3& toLight, const Pair& pair) const {
    const Vec3 h = toEye + toLight;
    const float ce = pair.eyeAbs(), cl = pair.lightAbs();
    return {h, pair.n, ce, cl, facets(h, ce + cl, toEye, toLight, pair)};
}

/// f of the sheen. The caller excludes light that ns does not see.
Rgb Bsdf::sheenValue(const Vec3& toEye, const Vec3& toLight, const Pair& pair, const Choice& eye,
                     const Choice& light) const {
    const float ce = pair.eyeAbs(), cl = pair.lightAbs();
    const float across2 = lengthSquared(cross(toEye + toLight, pair.n));
    const float alpha = sheen::alphaOf(sheenRoughness_.value());
    const sheen::Shadowing<float> shadowing(alpha);
    const float d = sheen::distribution(alpha, across2 / (across2 + (ce + cl) * (ce + cl)));
    const float v = 0.25f / ((1.0f + shadowing.lambda(ce) + shadowing.lambda(cl)) * ce * cl);
    // The bound keeps the albedo of a white sheen at or below 1 for every direction.
    const float bound = 1.0f / std::max(1.0f, std::max(eye.sheen, light.sheen));
    return sheenColor_.value() * (d * v * bound * pair.adjoint * underCoat(eye, light));
}

/// All lobes that have a density; those of layers and glass are about pair.n. The diffuse base uses
/// ns for the light and ng for the eye.
// One result variable per function, filled in place: a copy would stall on the stores to its parts.
[[gnu::always_inline]] inline BsdfEvaluation Bsdf::lobesAbout(const Pair& pair, const Vec3& toEye,
                                                              const Vec3& toLight,
                                                              const Cosines& c) const {
    BsdfEvaluation out;
    const bool reflects = c.reflects();
    if (!reflects && !has(kRoughGlass | kThrough)) return out;
    const Choice eye = choose(pair.eyeAbs());
    const Choice light = choose(pair.lightAbs());
    if (reflects ? has(kDiffuse | kSheen) : has(kThrough)) {
        // Light that ns does not see is not scattered, but a light walk from it may still draw this
        // lobe.
        out.pdfWToEye = (reflects ? light.diffuse : light.through) * std::abs(c.eyeG) * kInvPi;
        if (c.lightSeen()) {
            const float lightS = std::abs(c.lightS);
            const Choice base = lightS == pair.lightAbs() ? light : choose(lightS);
            out.f = widePart(toEye, toLight, pair, eye, light, base, c);
            out.pdfWToLight = (reflects ? eye.diffuse : eye.through) * lightS * kInvPi;
        }
    }
    if (!reflects) {
        if (!has(kRoughGlass)) return out;
        if (has(kThin)) {
            addRoughThinTransmission(toEye, toLight, pair, eye, light, out);
        } else {
            addRoughRefraction(toEye, toLight, pair, eye, light, out);
        }
        return out;
    }
    if (has(kRoughLayers | kRoughGlass)) {
        addRoughReflection(toEye, toLight, pair, eye, light, out);
    }
    if (clearcoatAlpha_ > 0.0f) {
        addRoughClearcoat(toEye, toLight, pair, eye, light, out);
    }
    return out;
}

BsdfEvaluation Bsdf::evaluateLobes(const Vec3& toEye, const Vec3& toLight) const {
    Cosines c;
    if (!connectable() || !makeCosines(toEye, toLight, c)) {
        return {};
    }
    if (has(kOwnCoatNormal)) {
        return evaluateUnderCoat(toEye, toLight, ScatterEvent::Smooth);
    }
    if (!isTilted()) {
        return lobesAbout(aboutNg(c), toEye, toLight, c);
    }
    return evaluateTilted(toEye, toLight, c);
}

Rgb Bsdf::diffusePart(const Vec3& toEye, const Vec3& toLight) const {
    Cosines c;
    if (!has(kWide) || !makeCosines(toEye, toLight, c) || !c.lightSeen()) {
        return Rgb{};
    }
    if (has(kOwnCoatNormal)) return diffusePartUnderCoat(toEye, toLight);
    const Choice base = choose(std::abs(c.lightS));
    const auto about = [&](const Pair& pair) {
        return widePart(toEye, toLight, pair, choose(pair.eyeAbs()), choose(pair.lightAbs()), base,
                        c);
    };
    if (!isTilted()) return about(aboutNg(c));
    const float eyeNg = eyeShare(c.eyeS, c.eyeG);
    Rgb part;
    if (eyeNg < 1.0f) part += about(aboutNs(c)) * (1.0f - eyeNg);
    if (eyeNg > 0.0f) part += about(aboutNg(c)) * eyeNg;
    return part;
}

/// f of diffuse base and sheen. `base`: the choice for the light about ns, whatever the pair's normal is.
inline Rgb Bsdf::widePart(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                          const Choice& eye, const Choice& light, const Choice& base,
                          const Cosines& c) const {
    if (!c.reflects()) {
        return has(kThrough) ? diffuseValue(throughColor(), eye, base, c) : Rgb{};
    }
    Rgb value;
    if (has(kDiffuse)) value = diffuseValue(reflectedColor(), eye, base, c);
    if (has(kSheen)) value += sheenValue(toEye, toLight, pair, eye, light);
    return value;
}

/// The mixture of the parts about both normals, which partAbout(pair) computes. `byNs`, `byNg`:
/// whether there is a part about that normal.
template <class PartAbout>
inline BsdfEvaluation Bsdf::mixture(const Cosines& c, float eyeNg, bool byNs, bool byNg,
                                    const PartAbout& partAbout) const {
    BsdfEvaluation out;
    const float lightNg = lightShare(c.lightS, c.lightG);
    const auto add = [&](const BsdfEvaluation& part, float seenByEye, float pickedByLight) {
        out.f += part.f * seenByEye;
        out.pdfWToLight += part.pdfWToLight * seenByEye;
        out.pdfWToEye += part.pdfWToEye * pickedByLight;
    };
    if (byNs && c.lightSeen()) add(partAbout(aboutNs(c)), 1.0f - eyeNg, 1.0f - lightNg);
    if (byNg) add(partAbout(aboutNg(c)), eyeNg, lightNg);
    return out;
}

/// evaluateLobes() where ns != ng.
BsdfEvaluation Bsdf::evaluateTilted(const Vec3& toEye, const Vec3& toLight,
                                    const Cosines& c) const {
    const float eyeNg = eyeShare(c.eyeS, c.eyeG);
    const bool byNs = eyeNg < 1.0f;
    const bool byNg = eyeNg > 0.0f;
    return mixture(c, eyeNg, byNs, byNg,
                   [&](const Pair& pair) { return lobesAbout(pair, toEye, toLight, c); });
}

void Bsdf::addRoughReflection(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                              const Choice& eye, const Choice& light, BsdfEvaluation& out) const {
    const Lobe lobe = baseLobe(toEye, toLight, pair);

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
    const Vec3 h = toEye + toLight;
    const float ce = pair.eyeAbs(), cl = pair.lightAbs();
    const Lobe lobe(h, pair.n, ce, cl,
                    Facets::isotropic(h, ce + cl, pair.n, ce, cl, clearcoatAlpha_));
    const float reflectance = clearcoat_ * fresnelDielectric(lobe.cosine, kClearcoatIor);
    out.f += Rgb(reflectance * lobe.k * lobe.g2 * pair.adjoint);
    out.pdfWToLight += eye.clearcoat * lobe.k * lobe.g1Eye;
    out.pdfWToEye += light.clearcoat * lobe.k * lobe.g1Light;
}

// The reflection lobe mirrored through the surface [glTF 2.0, KHR_materials_transmission].
// Mirroring toLight about n leaves its tangential part, hence H x n, as it is.
void Bsdf::addRoughThinTransmission(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                                    const Choice& eye, const Choice& light,
                                    BsdfEvaluation& out) const {
    const Lobe lobe = baseLobe(toEye, toLight, pair);
    const float transmit = 1.0f - fresnelDielectric(lobe.cosine, ior_);
    out.f +=
        baseColor_ * (glass() * transmit * through(eye, light) * lobe.k * lobe.g2 * pair.adjoint);
    out.pdfWToLight += eye.glass * transmit * lobe.k * lobe.g1Eye;
    out.pdfWToEye += light.glass * transmit * lobe.k * lobe.g1Light;
}

void Bsdf::addRoughRefraction(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                              const Choice& eye, const Choice& light, BsdfEvaluation& out) const {
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
        return;  // no microfacet refracts one to the other
    }
    const Vec3 h = o + i * ior_;
    const float cross2 = lengthSquared(cross(h, pair.n));
    const float h2 = hn * hn + cross2;
    const float cosine = std::min(1.0f, oh / std::sqrt(h2));
    // |eta_o o.h + eta_i i.h| = |H|: K = D |o.h| |i.h| / |H|^2 = D oh |ih| / |H|^4.
    const auto [d, se, sl] = facets(h, hn, toEye, toLight, pair);
    const float k = d * oh * -ih / (h2 * h2);
    const float transmit = 1.0f - fresnelDielectric(cosine, ior_);
    const float etaEye = indexOn(eyeOutside);
    const float etaLight = indexOn(!eyeOutside);

    out.f += baseColor_ * (glass() * transmit * through(eye, light) * etaEye * etaEye * k *
                           ggx::g2OverCosines(ce, se, cl, sl) * pair.adjoint);
    out.pdfWToLight += eye.glass * transmit * etaLight * etaLight * k * ggx::g1OverCosine(ce, se);
    out.pdfWToEye += light.glass * transmit * etaEye * etaEye * k * ggx::g1OverCosine(cl, sl);
}

BsdfEvaluation Bsdf::evaluateDelta(const Vec3& toEye, const Vec3& toLight,
                                   ScatterEvent event) const {
    Cosines c;
    if (event == ScatterEvent::Smooth || !makeCosines(toEye, toLight, c) ||
        c.reflects() != (event == ScatterEvent::DeltaReflection)) {
        return {};
    }
    if (has(kOwnCoatNormal)) return evaluateUnderCoat(toEye, toLight, event);
    if (!isTilted()) {
        return deltaAbout(aboutNg(c), c, event);
    }
    const float eyeNg = eyeShare(c.eyeS, c.eyeG);
    // Each normal has its own event, which the directions identify. Straight transmission belongs to both.
    const bool straight = event == ScatterEvent::DeltaTransmission && has(kThin);
    const bool byNg = straight ? eyeNg > 0.0f : isAboutNg(toEye, toLight, event);
    const bool byNs = straight ? eyeNg < 1.0f : !byNg;
    return mixture(c, eyeNg, byNs, byNg,
                   [&](const Pair& pair) { return deltaAbout(pair, c, event); });
}

bool Bsdf::isAboutNg(const Vec3& toEye, const Vec3& toLight, ScatterEvent event) const {
    // First by the shares: for normals that differ only in their last bits, the directions cannot tell them apart.
    const float share = shareAboutNg(toEye);
    if (share <= 0.0f || (event == ScatterEvent::DeltaTransmission && has(kThin))) return false;
    if (share >= 1.0f) return true;
    const Vec3 h =
        event == ScatterEvent::DeltaReflection
            ? toEye + toLight
            : toEye * indexOn(dot(toEye, ng_) > 0) + toLight * indexOn(dot(toLight, ng_) > 0);
    return lengthSquared(cross(h, ng_)) < lengthSquared(cross(h, ns_));
}

float Bsdf::shareAboutNg(const Vec3& toEye) const {
    const float eyeG = dot(toEye, ng_);
    return isTilted() ? eyeShare(eyeG + dot(toEye, ns_ - ng_), eyeG) : 0.0f;
}

bool Bsdf::has(ScatterEvent event) const {
    switch (event) {
        case ScatterEvent::Smooth:
            return false;
        case ScatterEvent::DeltaReflection:
            return hasDeltaLayers() || hasDeltaGlass() || hasDeltaClearcoat();
        case ScatterEvent::DeltaTransmission:
            return hasDeltaGlass();
    }
    return false;
}

/// The delta event about pair.n.
BsdfEvaluation Bsdf::deltaAbout(const Pair& pair, const Cosines& c, ScatterEvent event) const {
    BsdfEvaluation out;
    const bool deltaLayers = hasDeltaLayers();
    const bool deltaGlass = hasDeltaGlass();
    const bool deltaClearcoat = hasDeltaClearcoat();
    const float ce = pair.eyeAbs();
    const float cl = pair.lightAbs();
    const bool front = pair.eye > 0.0f;
    const Choice eye = choose(ce);
    const Choice light = choose(cl);
    if (event == ScatterEvent::DeltaTransmission) {
        if (!deltaGlass) {
            return out;
        }
        if (isPane_) {
            const Interface pane = interfaceAt(ce, relativeIndex(front));
            out.f = pane.transmitted;
            out.pdfWToLight = (1.0f - pane.pmf) * std::abs(c.lightG);
            out.pdfWToEye = (1.0f - pane.pmf) * std::abs(c.eyeG);
            return out;
        }
        // Computed from the outside, where there is no total internal reflection. Both sides of a
        // thin sheet are outside.
        const float transmit = 1.0f - fresnelDielectric(front || has(kThin) ? ce : cl, ior_);
        const Rgb coefficient = baseColor_ * (glass() * transmit * through(eye, light));
        if (has(kThin)) {
            // Straight transmission for every normal: both parts drop the same delta, that about
            // ng.
            out.f = coefficient;
            out.pdfWToLight = eye.glass * transmit * std::abs(c.lightG);
            out.pdfWToEye = light.glass * transmit * std::abs(c.eyeG);
            return out;
        }
        const float etaEye = indexOn(front);
        const float etaLight = indexOn(!front);
        out.f = coefficient * (etaEye * etaEye * pair.adjoint);
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
        const Interface inner = interfaceAt(ce, relativeIndex(front));
        reflectance += Rgb(glass() * inner.reflected);
        pmfEye += eye.glass * inner.pmf;
        pmfLight += light.glass * inner.pmf;
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

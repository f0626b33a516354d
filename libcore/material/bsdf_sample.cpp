// Sampling: a lobe by Bsdf::choose, a direction by that lobe, then the evaluation of the whole
// event. Both walks use the same density of `to` given `from`; only the roles differ.
#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/bsdf_inl.h"
#include "libcore/material/fresnel.h"
#include "libcore/material/microfacet.h"

namespace lacuna {
namespace {

/// `n` on the side of `from`; cosine = from.n.
Vec3 reflected(Vec3 from, Vec3 n, float cosine) {
    return n * (2.0f * cosine) - from;
}

/// Refraction; eta = transmitted over incident index. Call it only where Fresnel's reflectance is
/// < 1.
Vec3 refracted(Vec3 from, Vec3 n, float cosine, float eta) {
    const float inverse = 1.0f / eta;
    const float sine2 = std::max(0.0f, 1.0f - cosine * cosine) * inverse * inverse;
    const float cosineT = std::sqrt(std::max(0.0f, 1.0f - sine2));
    return n * (cosine * inverse - cosineT) - from * inverse;
}

}  // namespace

std::optional<BsdfSample> Bsdf::sample(Side side, Vec3 from, float uLobe, float u1,
                                       float u2) const {
    const float fromS = dot(from, ns_);
    if (isBlack() || !(std::abs(fromS) >= kMinCosine)) {
        return std::nullopt;
    }
    const bool front = fromS > 0.0f;
    const Vec3 n = front ? ns_ : -ns_;
    const float cosine = std::min(1.0f, std::abs(fromS));
    const Choice choice = choose(cosine);

    BsdfSample s;
    s.event = ScatterEvent::Smooth;
    // The probabilities add up to 1 but for rounding: the last lobe that exists takes the rest.
    if (uLobe < choice.diffuse || !has(kLayers | kGlass)) {
        s.to = Frame(n).toWorld(cosineHemisphere(u1, u2));
    } else {
        const bool glass = has(kGlass) && !(uLobe < choice.diffuse + choice.layers);
        const bool rough = has(glass ? kRoughGlass : kRoughLayers);
        Vec3 h = n;
        float hCosine = cosine;
        if (rough) {
            const Frame frame(n);
            const Vec2 p = concentricDisk(u1, u2);
            h = frame.toWorld(ggx::visibleNormal(frame.toLocal(from), alpha_, p.x, p.y));
            hCosine = std::min(1.0f, dot(from, h));
            if (!(hCosine > 0.0f)) {
                return std::nullopt;
            }
        }
        bool transmits = false;
        if (glass) {
            // What is left of uLobe decides between reflection (F) and transmission (1 - F).
            const float u = (uLobe - choice.diffuse - choice.layers) / choice.glass;
            transmits = !(u < fresnelDielectric(hCosine, relativeIndex(front)));
        }
        if (!transmits) {
            s.to = reflected(from, h, hCosine);
        } else if (!has(kThin)) {
            s.to = refracted(from, h, hCosine, relativeIndex(front));
        } else if (rough) {
            const Vec3 mirrored = reflected(from, h, hCosine);
            s.to = mirrored - n * (2.0f * dot(mirrored, n));
            if (!(dot(mirrored, n) > 0.0f)) {
                return std::nullopt;  // the lobe lies beyond the horizon: not on the other side
            }
        } else {
            s.to = -from;
        }
        if (!rough) {
            s.event = transmits ? ScatterEvent::DeltaTransmission : ScatterEvent::DeltaReflection;
        }
        if (rough && transmits != ((dot(s.to, n) < 0.0f))) {
            return std::nullopt;  // reflected below the horizon, or refracted above it
        }
    }
    s.to = normalize(s.to);
    s.evaluation =
        side == Side::Eye ? evaluate(from, s.to, s.event) : evaluate(s.to, from, s.event);
    const float pdfW = side == Side::Eye ? s.evaluation.pdfWToLight : s.evaluation.pdfWToEye;
    if (!(pdfW > 0.0f)) {
        return std::nullopt;
    }
    return s;
}

}  // namespace lacuna

// Sampling: Bsdf::choose gives the probabilities of the lobes, the chosen lobe samples a direction,
// and the whole event is evaluated. Both walks use the same density of `to` given `from`; only the
// roles differ.
#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/bsdf_inl.h"
#include "libcore/material/fresnel.h"
#include "libcore/material/microfacet.h"

namespace lacuna {
namespace {

/// The mirror direction. `n` is on the side of `from`; cosine = from.n.
Vec3 reflected(Vec3 from, Vec3 n, float cosine) {
    return n * (2.0f * cosine) - from;
}

/// The refracted direction; eta = transmitted over incident index. To be called only if the Fresnel
/// reflectance is < 1.
Vec3 refracted(Vec3 from, Vec3 n, float cosine, float eta) {
    const float inverse = 1.0f / eta;
    const float sine2 = std::max(0.0f, 1.0f - cosine * cosine) * inverse * inverse;
    const float cosineT = std::sqrt(std::max(0.0f, 1.0f - sine2));
    return n * (cosine * inverse - cosineT) - from * inverse;
}

/// A visible normal of the GGX lobe about `n`, seen from `from`.
Vec3 visibleNormal(Vec3 from, Vec3 n, float cosine, float alpha, float u1, float u2) {
    const Vec3 tangential = from - n * cosine;
    const float sine2 = lengthSquared(tangential);
    // If `from` is nearly along n, any tangent will do: the lobe's asymmetry is then of the order
    // of the sine.
    const bool tilted = sine2 > 1e-6f;
    const float sine = tilted ? std::sqrt(sine2) : 0.0f;
    const Vec3 s = tilted ? tangential * (1.0f / sine) : Frame(n).s;
    const Vec3 h = ggx::visibleNormal(sine, cosine, alpha, concentricDisk(u1, u2));
    return renormalize(s * h.x + cross(n, s) * h.y + n * h.z);
}

}  // namespace

std::optional<BsdfSample> Bsdf::sample(Side side, const Vec3& from, float uLobe, float u1,
                                       float u2) const {
    std::optional<BsdfSample> result;
    const float fromG = dot(from, ng_), fromS = fromG + dot(from, ns_ - ng_);
    if (isBlack() || !(std::abs(fromG) >= kMinCosine)) {
        return result;
    }
    if (has(kOwnCoatNormal)) return sampleUnderCoat(side, from, uLobe, u1, u2);
    // uLobe picks the normal and is rescaled to be uniform again.
    const bool tilted = isTilted() && !isLambert();
    float shareNg = 0.0f, u = uLobe;
    if (tilted) {
        shareNg = side == Side::Eye ? eyeShare(fromS, fromG) : lightShare(fromS, fromG);
    }
    const bool byNg = uLobe < shareNg;
    if (shareNg > 0.0f) {
        u = byNg ? uLobe / shareNg : std::min((uLobe - shareNg) / (1.0f - shareNg), 0x1.fffffep-1f);
    }
    const bool front = fromG > 0.0f;
    const float sign = front ? 1.0f : -1.0f;
    const Vec3 n = (byNg ? ng_ : ns_) * sign;
    const float fromN = (byNg ? fromG : fromS) * sign;
    if (!(fromN >= kMinCosine) && !isLambert()) {
        return result;
    }
    const float cosine = std::min(1.0f, fromN);
    const Choice choice = choose(cosine);

    Vec3 to;
    ScatterEvent event = ScatterEvent::Smooth;
    bool transmits = false;
    // The probabilities add up to 1 but for rounding: the last existing lobe takes the rest.
    const bool clearcoat = u < choice.clearcoat;
    const float uBase = u - choice.clearcoat;
    const float wide = choice.diffuse + choice.through;
    if (!clearcoat && (uBase < wide || !has(kLayers | kGlass))) {
        transmits = has(kThrough) && !(uBase < choice.diffuse);
        const float hemisphere = transmits ? -sign : sign;
        to = Frame((side == Side::Eye ? ns_ : ng_) * hemisphere).toWorld(cosineHemisphere(u1, u2));
    } else {
        const bool glass = !clearcoat && has(kGlass) && !(uBase < wide + choice.layers);
        const float alpha = clearcoat ? clearcoatAlpha_ : alpha_;
        const bool rough =
            clearcoat ? clearcoatAlpha_ > 0.0f : has(glass ? kRoughGlass : kRoughLayers);
        Vec3 h = n;
        if (rough) {
            h = has(kBrushed) && !clearcoat
                    ? ggx::visibleNormal(from, n, cosine, grainAbout(n), concentricDisk(u1, u2))
                    : visibleNormal(from, n, cosine, alpha, u1, u2);
        }
        const float hCosine = rough ? std::min(1.0f, dot(from, h)) : cosine;
        if (!(hCosine > 0.0f)) {
            return result;
        }
        if (glass) {
            // The rescaled rest of uBase decides between reflection (F) and transmission.
            const float uGlass = (uBase - wide - choice.layers) / choice.glass;
            // Never transmission if F is 1, although rounding may raise uGlass to 1.
            const float reflects = interfaceAt(hCosine, relativeIndex(front)).pmf;
            transmits = !(uGlass < reflects) && reflects < 1.0f;
        }
        if (!transmits) {
            to = reflected(from, h, hCosine);
        } else if (!has(kThin)) {
            to = refracted(from, h, hCosine, relativeIndex(front));
        } else if (rough) {
            const Vec3 mirrored = reflected(from, h, hCosine);
            to = mirrored - n * (2.0f * dot(mirrored, n));
        } else {
            to = -from;
        }
        if (!rough) {
            event = transmits ? ScatterEvent::DeltaTransmission : ScatterEvent::DeltaReflection;
        } else if (transmits != (dot(to, n) < 0.0f)) {
            return result;  // reflected below the horizon, or refracted above it
        }
    }
    to = renormalize(to);
    if (tilted) {
        const float toG = dot(to, ng_);
        if (transmits != (toG * sign < 0.0f)) {
            return result;  // on the wrong side of the surface
        }
        if (side == Side::Light) {
            const float eyeNg = eyeShare(toG + dot(to, ns_ - ng_), toG);
            if (byNg ? !(eyeNg > 0.0f) : !(eyeNg < 1.0f)) {
                return result;  // the eye there does not see lobes about this normal
            }
        }
    }
    BsdfSample& s = result.emplace();
    s.to = to;
    s.event = event;
    // By reference: a copy would stall on the stores to its parts.
    const Vec3& toEye = side == Side::Eye ? from : s.to;
    const Vec3& toLight = side == Side::Eye ? s.to : from;
    s.evaluation = evaluate(toEye, toLight, event);
    if (!((side == Side::Eye ? s.evaluation.pdfWToLight : s.evaluation.pdfWToEye) > 0.0f)) {
        result.reset();
    }
    return result;
}

}  // namespace lacuna

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

/// A visible normal of the GGX lobe about `n`, seen from `from`.
Vec3 visibleNormal(Vec3 from, Vec3 n, float cosine, float alpha, float u1, float u2) {
    const Vec3 tangential = from - n * cosine;
    const float sine2 = lengthSquared(tangential);
    // Nearly along n any tangent will do: the lobe's asymmetry there is of the order of the sine.
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
    const float fromS = dot(from, ns_);
    if (isBlack() || !(std::abs(fromS) >= kMinCosine)) {
        return result;
    }
    const bool front = fromS > 0.0f;
    const Vec3 n = front ? ns_ : -ns_;
    const float cosine = std::min(1.0f, std::abs(fromS));
    const Choice choice = choose(cosine);

    Vec3 to;
    ScatterEvent event = ScatterEvent::Smooth;
    // The probabilities add up to 1 but for rounding: the last lobe that exists takes the rest.
    const bool clearcoat = uLobe < choice.clearcoat;
    const float uBase = uLobe - choice.clearcoat;
    if (!clearcoat && (uBase < choice.diffuse || !has(kLayers | kGlass))) {
        to = Frame(n).toWorld(cosineHemisphere(u1, u2));
    } else {
        const bool glass = !clearcoat && has(kGlass) && !(uBase < choice.diffuse + choice.layers);
        const float alpha = clearcoat ? clearcoatAlpha_ : alpha_;
        const bool rough =
            clearcoat ? clearcoatAlpha_ > 0.0f : has(glass ? kRoughGlass : kRoughLayers);
        const Vec3 h = rough ? visibleNormal(from, n, cosine, alpha, u1, u2) : n;
        const float hCosine = rough ? std::min(1.0f, dot(from, h)) : cosine;
        if (!(hCosine > 0.0f)) {
            return result;
        }
        bool transmits = false;
        if (glass) {
            // What is left of uBase decides between reflection (F) and transmission (1 - F).
            const float u = (uBase - choice.diffuse - choice.layers) / choice.glass;
            // Never transmission where F is 1, though rounding may bring u up to 1.
            const float fresnel = fresnelDielectric(hCosine, relativeIndex(front));
            transmits = !(u < fresnel) && fresnel < 1.0f;
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
    BsdfSample& s = result.emplace();
    s.to = renormalize(to);
    s.event = event;
    // By reference: a copy would wait for its parts' stores.
    const Vec3& toEye = side == Side::Eye ? from : s.to;
    const Vec3& toLight = side == Side::Eye ? s.to : from;
    s.evaluation = evaluate(toEye, toLight, event);
    if (!((side == Side::Eye ? s.evaluation.pdfWToLight : s.evaluation.pdfWToEye) > 0.0f)) {
        result.reset();
    }
    return result;
}

}  // namespace lacuna

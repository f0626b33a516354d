// Sampling: a lobe by Bsdf::choose, a direction by that lobe, then the evaluation of the whole
// event. Both walks use the same lobes given what these see of `from`; the roles differ, and the
// images that a tilted ns makes of either.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "libcore/base/sampling.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/bsdf_inl.h"
#include "libcore/material/fresnel.h"
#include "libcore/material/microfacet.h"

namespace lacuna {
namespace {

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

/// Makes of the direction from which a walk comes the one that the lobes see, one of two by uLobe,
/// which becomes uniform again. cosine: about ns, of either.
inline void Bsdf::see(Side side, float fromG, Vec3& from, float& cosine, float& uLobe) const {
    if (side == Side::Eye) {
        if (cosine * fromG < 0.0f) {
            from = mirrored(from, ns_, cosine);
            cosine = -cosine;
        }
        return;
    }
    const LightImages images = lightImages(cosine, fromG);
    if (uLobe < images.pmf[0]) {
        uLobe /= images.pmf[0];
        return;
    }
    from = mirrored(from, ng_, fromG);
    cosine = images.cosine[1];
    uLobe = (uLobe - images.pmf[0]) / images.pmf[1];
}

/// Makes of the direction in which the lobes send a walk the one that leaves the surface. False
/// where none does.
inline bool Bsdf::leave(Side side, bool image, Vec3& to) const {
    const float toS = dot(to, ns_), toG = dot(to, ng_);
    const bool intoSurface = toS * toG < 0.0f;
    if (side == Side::Eye) {
        if (intoSurface) to = mirrored(to, ng_, toG);
        return true;
    }
    if (image && hasEyeImage(toS, toG)) to = mirrored(to, ns_, toS);
    return !intoSurface;  // no eye is there, nor at its image
}

std::optional<BsdfSample> Bsdf::sample(Side side, const Vec3& from, float uLobe, float u1,
                                       float u2) const {
    std::optional<BsdfSample> result;
    const float fromG = dot(from, ng_);
    float fromS = dot(from, ns_);
    if (isBlack() || !((std::abs(fromS) >= kMinCosine) & (std::abs(fromG) >= kMinCosine)) ||
        (side == Side::Light && fromS * fromG < 0.0f)) {
        return result;
    }
    // The last of uLobe's 24 bits decides between the eye's images, and nothing else.
    const bool image = (std::uint32_t(uLobe * 0x1p24f) & 1u) != 0;
    const bool bent = ns_ != ng_;
    Vec3 seen = from;
    if (bent) see(side, fromG, seen, fromS, uLobe);
    const bool front = fromG > 0.0f;
    const Vec3 n = front ? ns_ : -ns_;
    const float cosine = std::min(1.0f, std::abs(fromS));
    const Choice choice = choose(cosine);

    Vec3 to;
    ScatterEvent event = ScatterEvent::Smooth;
    // The probabilities add up to 1 but for rounding: the last lobe that exists takes the rest.
    const bool clearcoat = uLobe < choice.clearcoat;
    const float uBase = uLobe - choice.clearcoat;
    if (!clearcoat && (uBase < choice.diffuse || !has(kLayers | kGlass))) {
        // A diffuse base is equally bright from everywhere above ng.
        const Vec3 up = side == Side::Eye ? n : front ? ng_ : -ng_;
        to = Frame(up).toWorld(cosineHemisphere(u1, u2));
    } else {
        const bool glass = !clearcoat && has(kGlass) && !(uBase < choice.diffuse + choice.layers);
        const float alpha = clearcoat ? clearcoatAlpha_ : alpha_;
        const bool rough =
            clearcoat ? clearcoatAlpha_ > 0.0f : has(glass ? kRoughGlass : kRoughLayers);
        const Vec3 h = rough ? visibleNormal(seen, n, cosine, alpha, u1, u2) : n;
        const float hCosine = rough ? std::min(1.0f, dot(seen, h)) : cosine;
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
        if (!rough) {
            to = smoothDirection(seen, front, cosine, transmits);
            event = transmits ? ScatterEvent::DeltaTransmission : ScatterEvent::DeltaReflection;
        } else {
            if (!transmits) {
                to = reflected(seen, h, hCosine);
            } else if (!has(kThin)) {
                to = refracted(seen, h, hCosine, relativeIndex(front));
            } else {
                const Vec3 through = reflected(seen, h, hCosine);
                to = mirrored(through, n, dot(through, n));
            }
            if (transmits != (dot(to, n) < 0.0f)) {
                return result;  // reflected below the horizon, or refracted above it
            }
        }
        if (bent && !leave(side, image, to)) {
            return result;
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

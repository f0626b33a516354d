// A clearcoat with a normal of its own: a layer of lacquer over a bumpy base, or a bumpy layer over a flat base. Coat
// and base are two BSDFs about two normals:
//
//     f = f_coat + f_base min(u(toEye), u(toLight)),   u(d) = 1 - clearcoat E(d)
//
// E(d) is taken about the normals by which an eye in direction d sees the coat. A walk first chooses between coat and
// base by the direction that it knows (coatShare), then samples that one alone.
// (theory.md, "BSDFs")
#include <algorithm>
#include <cmath>

#include "libcore/material/bsdf.h"
#include "libcore/material/bsdf_inl.h"

namespace lacuna {

Bsdf Bsdf::clearcoatAlone() const {
    Bsdf coat = *this;
    coat.flags_ = 0;
    coat.ns_ = coatNormal_.value();
    return coat;
}

Bsdf Bsdf::withoutClearcoat() const {
    Bsdf base = *this;
    base.clearcoat_ = base.clearcoatAlpha_ = 0.0f;
    base.flags_ = std::uint16_t(flags_ & ~unsigned(kOwnCoatNormal));
    return base;
}

/// For a coat alone: the share that it reflects of light from this direction.
float Bsdf::coatShare(const Vec3& direction) const {
    const float g = dot(direction, ng_), s = g + dot(direction, ns_ - ng_);
    const float byNg = eyeShare(s, g);
    const auto albedo = [&](float cosine) {
        return clearcoat_ * clearcoatAlbedo(std::min(1.0f, std::abs(cosine)));
    };
    return albedo(s) * (1.0f - byNg) + albedo(g) * byNg;
}

float Bsdf::underOwnClearcoat(const Vec3& toEye, const Vec3& toLight) const {
    if (!hasOwnClearcoat()) return 1.0f;
    const Bsdf coat = clearcoatAlone();
    return 1.0f - std::max(coat.coatShare(toEye), coat.coatShare(toLight));
}

namespace {

/// Probabilities that a walk chooses the coat or the base.
struct Shares {
    float coat, base;
};

/// `reflected`: share that the coat reflects. `albedo`: that of the base.
Shares sharesOf(float reflected, float albedo) {
    const float coat = reflected / (reflected + (1.0f - reflected) * albedo);
    return {coat, 1.0f - coat};
}

}  // namespace

BsdfEvaluation Bsdf::evaluateUnderCoat(const Vec3& toEye, const Vec3& toLight,
                                       ScatterEvent event) const {
    const Bsdf coat = clearcoatAlone(), base = withoutClearcoat();
    BsdfEvaluation onCoat, onBase;
    if (event == ScatterEvent::DeltaReflection) {
        // There are up to three mirror directions. The half vector tells to which normal this one
        // belongs, or to which two if they are nearly equal.
        const Vec3 h = toEye + toLight;
        const auto off = [&h](const Vec3& n) { return lengthSquared(cross(h, n)); };
        const float nearest = std::min({off(coat.ns_), off(base.ns_), off(ng_)});
        const auto isMirror = [&](const Bsdf& part) {
            const float farthest = nearest + 1e-6f * lengthSquared(h);
            const float byNg = part.shareAboutNg(toEye);
            return (byNg < 1.0f && off(part.ns_) <= farthest) ||
                   (byNg > 0.0f && off(ng_) <= farthest);
        };
        if (isMirror(coat)) onCoat = coat.evaluateDelta(toEye, toLight, event);
        if (isMirror(base)) onBase = base.evaluateDelta(toEye, toLight, event);
    } else {
        onCoat = coat.evaluate(toEye, toLight, event);
        onBase = base.evaluate(toEye, toLight, event);
    }
    const float toEyeOff = coat.coatShare(toEye), toLightOff = coat.coatShare(toLight);
    const float albedo = base.survivalAlbedo();
    const Shares eye = sharesOf(toEyeOff, albedo), light = sharesOf(toLightOff, albedo);
    return {onCoat.f + onBase.f * (1.0f - std::max(toEyeOff, toLightOff)),
            onCoat.pdfWToLight * eye.coat + onBase.pdfWToLight * eye.base,
            onCoat.pdfWToEye * light.coat + onBase.pdfWToEye * light.base};
}

Rgb Bsdf::diffusePartUnderCoat(const Vec3& toEye, const Vec3& toLight) const {
    return withoutClearcoat().diffusePart(toEye, toLight) * underOwnClearcoat(toEye, toLight);
}

std::optional<BsdfSample> Bsdf::sampleUnderCoat(Side side, const Vec3& from, float uLobe, float u1,
                                                float u2) const {
    const Bsdf coat = clearcoatAlone(), base = withoutClearcoat();
    const Shares shares = sharesOf(coat.coatShare(from), base.survivalAlbedo());
    constexpr float kBelowOne = 0x1.fffffep-1f;
    std::optional<BsdfSample> s =
        uLobe < shares.coat
            ? coat.sample(side, from, uLobe / shares.coat, u1, u2)
            : base.sample(side, from, std::min((uLobe - shares.coat) / shares.base, kBelowOne), u1,
                          u2);
    if (!s) return s;
    s->evaluation =
        side == Side::Eye ? evaluate(from, s->to, s->event) : evaluate(s->to, from, s->event);
    if (!((side == Side::Eye ? s->evaluation.pdfWToLight : s->evaluation.pdfWToEye) > 0.0f)) {
        s.reset();
    }
    return s;
}

}  // namespace lacuna

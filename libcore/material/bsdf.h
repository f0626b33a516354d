// The scattering function at one surface point: a value type, evaluated once from a Material and
// its textures, small enough to be stored in every path vertex.
//
// Conventions (theory.md, "BSDFs"; tests/doc/numerics.md, "BSDFs")
//
// * Directions are unit and point AWAY from the surface. Roles are physical, never "incoming or
//   outgoing of the walk": `toEye` leads towards the camera's end of the path, `toLight` towards
//   the light's end. f is the same function of (toEye, toLight) whichever walk asks, so the
//   asymmetries (refraction's eta^2, shading normals) need no transport mode.
// * f is taken against the PROJECTED SOLID ANGLE ABOUT THE GEOMETRIC NORMAL:
//       f(toEye, toLight) = f_ns(toEye, toLight) |toLight . ns| / |toLight . ng|     [Veach97 5.3.2]
//   with f_ns the BSDF about the shading normal, in the radiance convention: refraction carries
//   (eta_eye / eta_light)^2 of the radiance on the eye's side.
//   A step of either walk multiplies its throughput by f |to . ng| / pdfW(to).
// * A clearcoat with a normal of its own is a second Bsdf over the rest (bsdf_coat.cpp).
// * Delta events (mirror, smooth glass, a smooth coat) are written with the same formulas after the
//   common delta distribution has been dropped on both sides; this is the narrow-lobe limit, so the
//   balance heuristic over generalised densities is the limit of the balance heuristic:
//       pdfW = pmf eta_to^2 |to . ns|,    f_ns = coefficient eta_eye^2,
//   where eta_to (eta_eye) is the index of refraction on the side `to` (the eye) lies on; for a
//   reflection both indices are left out (1). coefficient: reflectance, or transmittance (no eta).
// * ng is the geometric normal by the winding (front side = outside of a solid).
//   ns lies on the same side as ng.
//   Nothing is one-sided: back faces reflect like front faces; a solid's inside
//   is the back.
// * ng alone says on which side of the surface a direction lies. Lobes about ns have nothing for an
//   eye whose mirror direction about ns lies inside the surface: silhouettes under a normal map
//   would be black. There the lobes turn about ng instead:
//       f = (1 - w) f_ns + w f_ng,   w = clamp(5 - 8 (ns . ng) (toEye . ns) / (toEye . ng), 0, 1),
//   which is 0 where ns = ng, and 1 from where that mirror direction touches the surface. w is of
//   toEye alone: seen from anywhere, the mixture reflects no more than its parts. A diffuse base
//   does not ask where the eye is: it keeps ns, and is equally bright from everywhere above ng.
// * A walk picks one of the two normals, then a lobe about it: an eye walk ng with probability w, a
//   light walk by what it knows of toLight (lightShare). What the light walk draws about a normal
//   that the eye there does not see at all is thrown away, and not in its density.
// * Directions with |to . ng| below kMinCosine scatter nothing and have density zero, in evaluate
//   and sample alike; so do toLight with |toLight . ns| below it, or on different sides of ng and
//   ns, in everything but the lobes about ng.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "libcore/base/sampling.h"
#include "libcore/base/vec.h"
#include "libcore/material/lobes.h"
#include "libcore/material/microfacet.h"
#include "libcore/material/packed.h"

namespace lacuna {

class AlbedoTable;
class AlbedoTables;

/// |cos| below this scatters nothing.
inline constexpr float kMinCosine = 1e-6f;
/// GGX alpha below this is a true delta: float half vectors cannot resolve such a lobe.
inline constexpr float kMinAlpha = 1e-4f;

/// What happened at a vertex; part of the path, like its position.
enum class ScatterEvent : std::uint8_t {
    Smooth,  ///< through the lobes that have a density (diffuse, rough): the vertex is connectable
    DeltaReflection,
    DeltaTransmission,
};
inline bool isDelta(ScatterEvent e) {
    return e != ScatterEvent::Smooth;
}

/// One evaluation: value and both densities, from the same half vector.
struct BsdfEvaluation {
    Rgb f;                  ///< see above; generalised (delta dropped) for delta events
    float pdfWToLight = 0;  ///< density of toLight when the eye's walk samples it, given toEye
    float pdfWToEye = 0;    ///< density of toEye when the light's walk samples it, given toLight
};

struct BsdfSample {
    Vec3 to;  ///< unit
    ScatterEvent event;
    BsdfEvaluation evaluation;  ///< evaluate(...) of exactly this pair and event
};

/// Whose walk samples: an eye walk knows toEye and samples toLight; a light walk the other way
/// round.
enum class Side : std::uint8_t { Light, Eye };

class Bsdf {
  public:
    /// What textures and factors gave at this point. All in [0, 1] but ior (>= 1) and
    /// specularColor (>= 0).
    struct Parameters {
        Rgb baseColor{0.0f};
        float metallic = 0.0f;
        float roughness = 1.0f;  ///< alpha = roughness^2; alpha < kMinAlpha counts as 0 (delta)
        float specular =
            1.0f;  ///< factor on the dielectric layer's reflectance; 0: exactly Lambert
        Rgb specularColor{1.0f};  ///< factor on its reflectance along the normal, up to 1
        float ior = 1.5f;
        float transmission = 0.0f;
        bool thin = true;
        /// Rays pass it straight, and what is left is of those that stop; only smooth thin glass alone.
        bool pane = false;
        float clearcoat = 0.0f;  ///< weight of a layer of index kClearcoatIor over everything else
        float clearcoatRoughness = 0.0f;
        /// The clearcoat's own shading normal, unit, on ng's side; zero: the one of what is under it.
        Vec3 clearcoatNormal{};
        /// Rougher along `tangent`: alpha there is mix(alpha, 1, anisotropy^2). Of metal, coat and
        /// glass. [KHR_materials_anisotropy]
        float anisotropy = 0.0f;
        Vec3 tangent{};        ///< of any length, also off the surface; zero: any
        Rgb sheenColor{0.0f};  ///< of cloth's fibres above everything but the clearcoat
        float sheenRoughness = 0.0f;
        /// What the diffuse base sends to the other side, and in which colour; the rest stays.
        float diffuseTransmission = 0.0f;
        Rgb diffuseTransmissionColor{1.0f};
        /// Lobes that are not there: a layer leaves its light to what is under it, the others'
        /// light is absorbed.
        LobeSet without = {};
    };
    static constexpr float kClearcoatIor = 1.5f;  // KHR_materials_clearcoat
    /// A brushed surface (anisotropy above 0) is nowhere smoother: alpha .001.
    static constexpr float kMinBrushedRoughness = 0.0316228f;

    Bsdf() = default;
    /// `tables` must outlive the Bsdf; it is read only where a dielectric layer lies over a diffuse
    /// base (a smooth layer merely gets its mean reflectance faster from it). A layer without a
    /// table of its own takes that of a larger index. Throws nothing.
    Bsdf(const Parameters& parameters, Vec3 ng, Vec3 ns, const AlbedoTables& tables);
    /// Whether lobes of this roughness are narrow.
    static bool isNarrow(float roughness) { return roughness * roughness < kNarrowAlpha; }
    /// The roughness that a surface has across its grain, where it is smoothest.
    static float roughnessOf(float roughness, float anisotropy);
    /// Index of the layer that reflects, along the normal, what `ior` does times the largest
    /// channel of `specularColor`: the one whose table the constructor looks for.
    static float layerIor(float ior, const Rgb& specularColor);
    /// The same material at another point.
    Bsdf at(Vec3 ng, Vec3 ns) const {
        Bsdf b = *this;
        b.ng_ = ng;
        b.ns_ = ns;
        return b;
    }
    /// The same in another colour. Neither of the two may be black.
    Bsdf at(Vec3 ng, Vec3 ns, const Rgb& baseColor) const;

    /// Value and densities of the Smooth event (all lobes with a density together).
    BsdfEvaluation evaluate(const Vec3& toEye, const Vec3& toLight) const {
        return isLambert() ? lambert(toEye, toLight) : evaluateLobes(toEye, toLight);
    }
    /// Generalised value and densities of one delta event; `toLight` must be the direction that the
    /// event leads to from `toEye` (not checked). Zero for Smooth.
    BsdfEvaluation evaluateDelta(const Vec3& toEye, const Vec3& toLight, ScatterEvent event) const;
    /// Dispatch on the event.
    BsdfEvaluation evaluate(const Vec3& toEye, const Vec3& toLight, ScatterEvent event) const {
        return event == ScatterEvent::Smooth ? evaluate(toEye, toLight)
                                             : evaluateDelta(toEye, toLight, event);
    }

    /// Samples the direction of `side`'s walk, given `from` (toEye for Side::Eye, toLight for
    /// Side::Light). uLobe, u1, u2 in [0, 1). Empty where the draw scatters nothing.
    std::optional<BsdfSample> sample(Side side, const Vec3& from, float uLobe, float u1,
                                     float u2) const;

    /// Whether any lobe has a density: only then may a path be connected here.
    bool connectable() const {
        return has(kWide | kRoughLayers | kRoughGlass) || clearcoatAlpha_ > 0.0f;
    }
    /// Whether it has delta events of this kind.
    bool has(ScatterEvent event) const;
    /// w: of what this eye sees, how much is of the lobes about ng.
    float shareAboutNg(const Vec3& toEye) const;
    /// Whether it is two layers about two normals: a clearcoat with one of its own and the rest. f is that of
    /// clearcoatAlone() and, times underOwnClearcoat(), that of withoutClearcoat().
    bool hasOwnClearcoat() const { return has(kOwnCoatNormal); }
    Bsdf clearcoatAlone() const;
    Bsdf withoutClearcoat() const;
    /// What the clearcoat leaves to the rest, 1 where it has no normal of its own.
    float underOwnClearcoat(const Vec3& toEye, const Vec3& toLight) const;
    /// Whether smooth transmission bends rays; those through a sheet go straight on.
    bool bends() const { return !has(kThin); }
    /// Index of refraction on a side; a sheet has the same on both.
    float indexOn(bool front) const { return front || has(kThin) ? 1.0f : ior_; }
    /// Transmitted over incident index for light that arrives from this side.
    float relativeIndex(bool front) const { return front || has(kThin) ? ior_ : 1.0f / ior_; }
    /// Share of the rays along `direction` (of any length) that go on straight as if nothing were there,
    /// a pane's; the same from both sides. What scatters is of the others. (theory.md, "Panes")
    float passing(const Vec3& direction) const;
    /// Whether light may pass through.
    bool transmits() const { return has(kGlass | kThrough); }
    /// What reflects in the Smooth event: a diffuse base or sheen, rough lobes, or both.
    bool isDiffuse() const { return has(kDiffuse | kSheen); }
    bool isGlossy() const { return has(kRoughLayers | kRoughGlass) || clearcoatAlpha_ > 0.0f; }
    /// What goes to the other side in the Smooth event: likewise.
    bool transmitsDiffusely() const { return has(kThrough); }
    bool transmitsGlossily() const { return has(kRoughGlass); }
    /// Of evaluate().f what the diffuse base and the sheen scatter; the rest is glossy.
    Rgb diffusePart(const Vec3& toEye, const Vec3& toLight) const;
    /// Whether there is no lobe that is wide beside others of the same surface.
    bool isNarrow() const { return !has(kWide) && alpha_ < kNarrowAlpha; }
    /// Whether it is nearly smooth glass: what it transmits goes through one narrow lobe, the same all around
    /// the normal.
    bool refractsNarrowly() const {
        return isNarrow() && has(kRoughGlass) && !has(kBrushed | kOwnCoatNormal);
    }
    /// alpha of that lobe.
    float narrowAlpha() const { return alpha_; }
    bool isBlack() const { return !has(kWide | kLayers | kGlass) && !(clearcoat_ > 0.0f); }
    /// Upper estimate of the albedo, the same from both sides: drives Russian roulette.
    float survivalAlbedo() const;
    /// Diffuse and specular colour together, for the albedo.* image layer.
    Rgb layerAlbedo() const;

    Vec3 ng() const { return ng_; }
    Vec3 ns() const { return ns_; }
    /// Whether the delta event that has these directions is one about ng and not about ns; those that go straight
    /// on are about either, and not so called.
    bool isAboutNg(const Vec3& toEye, const Vec3& toLight, ScatterEvent event) const;

  private:
    static constexpr float kNarrowAlpha = 0.1f;
    // Which lobes exist. Layers: coat and metal share alpha, half vector and density.
    enum Flag : std::uint16_t {
        kDiffuse = 1,
        kCoat = 2,
        kMetal = 4,
        kLayers = kCoat | kMetal,
        kGlass = 8,
        kThin = 16,
        kRoughLayers = 32,  ///< coat and metal have a density
        kRoughGlass = 64,
        kOneLobe = 128,  ///< exactly one of diffuse, layers, glass, no other: nothing to choose
        kThrough = 256,  ///< the diffuse base scatters to the other side too
        kSheen = 512,
        kBrushed = 1024,        ///< alpha depends on the direction
        kOwnCoatNormal = 2048,  ///< the clearcoat's normal is not ns
        kWide = kDiffuse | kThrough | kSheen,
    };

    /// Probabilities of the lobes given the one known direction, and what the coats leave to what
    /// is under them.
    struct Choice {
        float diffuse = 0;  ///< cosine-distributed, on the same side: base and sheen
        float through = 0;  ///< likewise, on the other side
        float layers = 0, glass = 0, clearcoat = 0;
        float open = 1;   ///< 1 - specular E(mu)
        float sheen = 0;  ///< E(mu) of a white sheen
        float bare = 1;   ///< what the sheen leaves
        float under = 1;  ///< 1 - clearcoat E(mu) of the clearcoat
    };
    /// What the clearcoat lets through, both ways, to anything but a diffuse base: the less open of
    /// the two, so that no base returns more than reaches it, and a mirror all of that.
    static float underCoat(const Choice& eye, const Choice& light) {
        return eye.under < light.under ? eye.under : light.under;
    }
    /// Likewise the sheen, to any base.
    static float underSheen(const Choice& eye, const Choice& light) {
        return eye.bare < light.bare ? eye.bare : light.bare;
    }
    static float through(const Choice& eye, const Choice& light) {
        return underCoat(eye, light) * underSheen(eye, light);
    }
    /// A pair of directions: signed cosines about both normals.
    struct Cosines {
        float eyeG, lightG, eyeS, lightS;
        bool reflects() const { return (eyeG > 0) == (lightG > 0); }
        /// Whether ns sees light here: not grazing, and on the side that ng says.
        bool lightSeen() const {
            return (std::abs(lightS) >= kMinCosine) & (lightG * lightS > 0.0f);
        }
    };
    /// A pair of directions as lobes about the normal n see it.
    struct Pair {
        Vec3 n;
        float eye, light;  ///< signed cosines about n
        float adjoint;     ///< |toLight . n| / |toLight . ng|
        float eyeAbs() const { return eye < 0 ? -eye : eye; }
        float lightAbs() const { return light < 0 ? -light : light; }
    };
    Pair aboutNs(const Cosines& c) const { return {ns_, c.eyeS, c.lightS, c.lightS / c.lightG}; }
    Pair aboutNg(const Cosines& c) const { return {ng_, c.eyeG, c.lightG, 1.0f}; }

    bool has(unsigned flags) const { return (flags_ & flags) != 0; }
    bool hasDeltaLayers() const { return has(kLayers) && !has(kRoughLayers); }
    bool hasDeltaGlass() const { return has(kGlass) && !has(kRoughGlass); }
    bool hasDeltaClearcoat() const { return clearcoat_ > 0.0f && !(clearcoatAlpha_ > 0.0f); }
    bool isTilted() const { return (ns_.x != ng_.x) | (ns_.y != ng_.y) | (ns_.z != ng_.z); }
    /// Diffuse and nothing else: there are no lobes to turn about ng.
    bool isLambert() const { return has(kDiffuse) && has(kOneLobe); }
    /// False where the pair scatters nothing, because it is grazing.
    bool makeCosines(const Vec3& toEye, const Vec3& toLight, Cosines& c) const {
        c.eyeG = dot(toEye, ng_);
        c.lightG = dot(toLight, ng_);
        // By the difference of the normals: exactly the same where they are.
        const Vec3 tilt = ns_ - ng_;
        c.eyeS = c.eyeG + dot(toEye, tilt);
        c.lightS = c.lightG + dot(toLight, tilt);
        // Bitwise: one branch. NaN fails every comparison.
        return (std::abs(c.eyeG) >= kMinCosine) & (std::abs(c.lightG) >= kMinCosine);
    }
    /// evaluate() of a diffuse lobe alone, where most of the time goes: inline.
    BsdfEvaluation lambert(const Vec3& toEye, const Vec3& toLight) const {
        BsdfEvaluation out;
        Cosines c;
        if (!makeCosines(toEye, toLight, c) || !c.lightSeen() || !c.reflects()) return out;
        out.f = baseColor_ * (diffuseScale_ * (c.lightS / c.lightG));
        out.pdfWToLight = std::abs(c.lightS) * kInvPi;
        out.pdfWToEye = std::abs(c.eyeG) * kInvPi;
        return out;
    }
    float eyeShare(float eyeS, float eyeG) const;
    float lightShare(float lightS, float lightG) const;
    template <class PartAbout>
    BsdfEvaluation mixture(const Cosines& c, float eyeNg, bool byNs, bool byNg,
                           const PartAbout& partAbout) const;
    BsdfEvaluation evaluateLobes(const Vec3& toEye, const Vec3& toLight) const;
    BsdfEvaluation evaluateTilted(const Vec3& toEye, const Vec3& toLight, const Cosines& c) const;
    BsdfEvaluation lobesAbout(const Pair& pair, const Vec3& toEye, const Vec3& toLight,
                              const Cosines& c) const;
    /// Of a diffuse base of this colour.
    Rgb diffuseValue(const Rgb& color, const Choice& eye, const Choice& base,
                     const Cosines& c) const {
        return color * (diffuseScale_ * eye.open * eye.under * base.open * base.under *
                        (c.lightS / c.lightG) * underSheen(eye, base));
    }
    Rgb reflectedColor() const { return baseColor_ * (1.0f - diffuseThrough_); }
    Rgb throughColor() const { return throughColor_.value() * diffuseThrough_; }
    Rgb widePart(const Vec3& toEye, const Vec3& toLight, const Pair& pair, const Choice& eye,
                 const Choice& light, const Choice& base, const Cosines& c) const;
    Rgb sheenValue(const Vec3& toEye, const Vec3& toLight, const Pair& pair, const Choice& eye,
                   const Choice& light) const;
    struct Facets;
    Facets facets(Vec3 h, float hn, const Vec3& toEye, const Vec3& toLight, const Pair& pair) const;
    /// The reflecting lobe of layers and glass.
    struct Lobe;
    Lobe baseLobe(const Vec3& toEye, const Vec3& toLight, const Pair& pair) const;
    /// How the surface is brushed as lobes about the normal n see it.
    ggx::Grain grainAbout(const Vec3& n) const;

    // A clearcoat with a normal of its own: two BSDFs, one over the other (bsdf_coat.cpp).
    float coatShare(const Vec3& direction) const;
    BsdfEvaluation evaluateUnderCoat(const Vec3& toEye, const Vec3& toLight,
                                     ScatterEvent event) const;
    Rgb diffusePartUnderCoat(const Vec3& toEye, const Vec3& toLight) const;
    std::optional<BsdfSample> sampleUnderCoat(Side side, const Vec3& from, float uLobe, float u1,
                                              float u2) const;
    BsdfEvaluation deltaAbout(const Pair& pair, const Cosines& c, ScatterEvent event) const;
    float coatAlbedo(float mu) const;
    float clearcoatAlbedo(float mu) const;
    float sheenAlbedo(float mu) const;
    float meanSheen() const;
    float openAverage(float coatAverage) const;
    Choice choose(float mu) const;
    Rgb layersReflectance(float cosine) const;
    float glass() const { return 1.0f - plastic_ - metal_; }

    /// What an event at smooth glass is: a pane's of the rays that stop.
    struct Interface {
        float reflected;  ///< reflectance
        Rgb transmitted;  ///< transmittance, a pane's alone
        float pmf;        ///< of a reflection
    };
    /// Seen at this cosine from a side with this relative index.
    Interface interfaceAt(float cosine, float relativeIndex) const;

    void addRoughReflection(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                            const Choice& eye, const Choice& light, BsdfEvaluation& out) const;
    void addRoughClearcoat(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                           const Choice& eye, const Choice& light, BsdfEvaluation& out) const;
    void addRoughThinTransmission(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                                  const Choice& eye, const Choice& light,
                                  BsdfEvaluation& out) const;
    void addRoughRefraction(const Vec3& toEye, const Vec3& toLight, const Pair& pair,
                            const Choice& eye, const Choice& light, BsdfEvaluation& out) const;

    // 128 bytes: it lives in every path vertex.
    const AlbedoTable* table_ = nullptr;  ///< only where the coat is rough and the base diffuse
    Vec3 ng_, ns_;
    Rgb baseColor_;
    float alpha_ = 0;
    float ior_ = 1;      ///< of the glass
    float coatIor_ = 1;  ///< of the coat's brightest channel
    /// (F0 - that of the channel) / (1 - F0): the coat reflects F - tintLoss (1 - F).
    Rgb tintLoss_;
    float plastic_ = 0, metal_ = 0;  ///< mixture weights; glass is the rest
    float specular_ = 0;
    float diffuseScale_ = 0;  ///< plastic / (pi times the mean of what all coats leave)
    float clearcoat_ = 0, clearcoatAlpha_ = 0;
    std::uint16_t flags_ = 0;
    std::uint8_t rowIndex_ : 7 = 0;  ///< AlbedoTable::Row
    std::uint8_t isPane_ : 1 = 0;
    std::uint16_t rowFraction_ = 0;
    float diffuseThrough_ = 0;  ///< share of the diffuse base
    PackedColor throughColor_, sheenColor_;
    PackedUnit sheenRoughness_;
    PackedUnit alphaAlong_;  ///< along the tangent; across it alpha_
    PackedDirection tangent_, coatNormal_;
};
static_assert(sizeof(Bsdf) <= 128);

}  // namespace lacuna

// The scattering function at one surface point. It is a value type, made once from a Material and
// its textures, and small enough to be stored in every path vertex.
//
// Conventions (theory.md, "BSDFs"; tests/doc/numerics.md, "BSDFs")
//
// * Directions are unit and point AWAY from the surface. Roles are physical, never "incoming or
//   outgoing of the walk": `toEye` leads towards the camera's end of the path, `toLight` towards
//   the light's end. f is the same function of (toEye, toLight) whichever walk evaluates it, so the
//   asymmetries (refraction's eta^2, shading normals) need no transport mode.
// * f is taken against the PROJECTED SOLID ANGLE ABOUT THE GEOMETRIC NORMAL:
//       f(toEye, toLight) = f_ns(toEye, toLight) |toLight . ns| / |toLight . ng|     [Veach97 5.3.2]
//   with f_ns the BSDF about the shading normal, in the radiance convention: refraction contains
//   (eta_eye / eta_light)^2 of the radiance on the eye's side.
//   A step of either walk multiplies its throughput by f |to . ng| / pdfW(to).
// * A clearcoat with a normal of its own is a second Bsdf over the rest (bsdf_coat.cpp).
// * Delta events (mirror, smooth glass, a smooth coat) use the same formulas after the common delta
//   distribution has been dropped on both sides. This is the narrow-lobe limit, so that the balance
//   heuristic over generalised densities is the limit of the balance heuristic:
//       pdfW = pmf eta_to^2 |to . ns|,    f_ns = coefficient eta_eye^2,
//   where eta_to (eta_eye) is the index of refraction on the side of `to` (of the eye); both are 1
//   for a reflection. coefficient: reflectance, or transmittance without eta.
// * ng is the geometric normal by the winding (front side = outside of a solid). ns lies on the
//   same side as ng. Nothing is one-sided: back faces reflect like front faces. The inside of a
//   solid is the back.
// * ng alone decides on which side of the surface a direction lies. Lobes about ns reflect nothing
//   to an eye whose mirror direction about ns lies inside the surface: silhouettes under a normal
//   map would be black. There, lobes about ng replace them:
//       f = (1 - w) f_ns + w f_ng,   w = clamp(5 - 8 (ns . ng) (toEye . ns) / (toEye . ng), 0, 1),
//   which is 0 where ns = ng, and 1 once that mirror direction touches the surface. w depends on
//   toEye alone, so that the mixture reflects to no eye more than its parts. A diffuse base keeps
//   ns, whatever toEye is, and is equally bright from everywhere above ng.
// * A walk picks one of the two normals, then a lobe about it. An eye walk picks ng with
//   probability w, a light walk with a probability that depends on toLight (lightShare). If the
//   light walk draws toEye about a normal that this eye does not see at all, the sample is
//   discarded; the density does not count it.
// * Directions with |to . ng| below kMinCosine scatter nothing and have density zero, in evaluate
//   and sample alike. The same holds, except in lobes about ng, for toLight with |toLight . ns|
//   below kMinCosine or with ng and ns on different sides of it.
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

/// The scattering event at a vertex. It is part of the path, like the vertex's position.
enum class ScatterEvent : std::uint8_t {
    Smooth,  ///< by lobes that have a density (diffuse, rough): the vertex is connectable
    DeltaReflection,
    DeltaTransmission,
};
inline bool isDelta(ScatterEvent e) {
    return e != ScatterEvent::Smooth;
}

/// One evaluation: the value and both densities, from the same half vector.
struct BsdfEvaluation {
    Rgb f;                  ///< see above; without the delta for delta events
    float pdfWToLight = 0;  ///< density of toLight given toEye, in an eye walk
    float pdfWToEye = 0;    ///< density of toEye given toLight, in a light walk
};

struct BsdfSample {
    Vec3 to;  ///< unit
    ScatterEvent event;
    BsdfEvaluation evaluation;  ///< evaluate(..) of this pair and event
};

/// The walk that samples: an eye walk knows toEye and samples toLight; a light walk knows toLight
/// and samples toEye.
enum class Side : std::uint8_t { Light, Eye };

class Bsdf {
  public:
    /// Material parameters at this point, from textures and factors. All are in [0, 1] except ior
    /// (>= 1) and specularColor (>= 0).
    struct Parameters {
        Rgb baseColor{0.0f};
        float metallic = 0.0f;
        float roughness = 1.0f;   ///< alpha = roughness^2; alpha < kMinAlpha counts as 0 (delta)
        float specular = 1.0f;    ///< factor of the dielectric layer's reflectance; 0: Lambertian
        Rgb specularColor{1.0f};  ///< factor of its reflectance at normal incidence, up to 1
        float ior = 1.5f;
        float transmission = 0.0f;
        bool thin = true;
        /// A pane: some rays pass it straight, and the lobes describe only those that stop. Only smooth thin glass
        /// without other lobes can be a pane.
        bool pane = false;
        float clearcoat = 0.0f;  ///< weight of a layer of index kClearcoatIor over everything else
        float clearcoatRoughness = 0.0f;
        /// The clearcoat's own unit shading normal on ng's side; zero: that of the layers under it.
        Vec3 clearcoatNormal{};
        /// Roughness along `tangent`: alpha there is mix(alpha, 1, anisotropy^2). For metal, coat
        /// and glass. [KHR_materials_anisotropy]
        float anisotropy = 0.0f;
        Vec3 tangent{};        ///< of any length, need not lie in the surface; zero: any
        Rgb sheenColor{0.0f};  ///< of the fibres of cloth; only the clearcoat is above
        float sheenRoughness = 0.0f;
        /// Share of the diffuse base's light that goes to the other side, and its colour.
        float diffuseTransmission = 0.0f;
        Rgb diffuseTransmissionColor{1.0f};
        /// Lobes to leave out. The light of a layer goes to what is under it; that of other lobes
        /// is absorbed.
        LobeSet without = {};
    };
    static constexpr float kClearcoatIor = 1.5f;  // KHR_materials_clearcoat
    /// The smallest roughness of a brushed surface (anisotropy above 0): alpha .001.
    static constexpr float kMinBrushedRoughness = 0.0316228f;

    Bsdf() = default;
    /// ng, ns: unit normals. `tables` must outlive the Bsdf. It is used only for a dielectric layer
    /// over a diffuse base (a smooth layer only gets its mean reflectance faster from it). A layer
    /// without a table of its index uses that of a larger one. Throws nothing.
    Bsdf(const Parameters& parameters, Vec3 ng, Vec3 ns, const AlbedoTables& tables);
    /// Whether lobes of this roughness are narrow.
    static bool isNarrow(float roughness) { return roughness * roughness < kNarrowAlpha; }
    /// The roughness of a surface across its grain, where it is smoothest.
    static float roughnessOf(float roughness, float anisotropy);
    /// The index of refraction whose reflectance at normal incidence is that of `ior` times the
    /// largest channel of `specularColor`. The constructor looks for the table of this index.
    static float layerIor(float ior, const Rgb& specularColor);
    /// The same material at another point.
    Bsdf at(Vec3 ng, Vec3 ns) const {
        Bsdf b = *this;
        b.ng_ = ng;
        b.ns_ = ns;
        return b;
    }
    /// The same with another base colour. Neither colour may be black.
    Bsdf at(Vec3 ng, Vec3 ns, const Rgb& baseColor) const;

    /// Value and densities of the Smooth event: the sum over all lobes with a density.
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

    /// Samples the next direction of the walk, given `from` (toEye for Side::Eye, toLight for
    /// Side::Light). uLobe, u1 and u2 are in [0, 1). Empty if the sample scatters nothing.
    std::optional<BsdfSample> sample(Side side, const Vec3& from, float uLobe, float u1,
                                     float u2) const;

    /// Whether any lobe has a density; only then can a path be connected here.
    bool connectable() const {
        return has(kWide | kRoughLayers | kRoughGlass) || clearcoatAlpha_ > 0.0f;
    }
    /// Whether it has delta events of this kind.
    bool has(ScatterEvent event) const;
    /// w: weight of the lobes about ng for this eye.
    float shareAboutNg(const Vec3& toEye) const;
    /// Whether the clearcoat has a normal of its own. Then f is that of clearcoatAlone() plus underOwnClearcoat() times
    /// that of withoutClearcoat().
    bool hasOwnClearcoat() const { return has(kOwnCoatNormal); }
    Bsdf clearcoatAlone() const;
    Bsdf withoutClearcoat() const;
    /// Share of light that such a clearcoat leaves to the rest; 1 where it has no normal of its
    /// own.
    float underOwnClearcoat(const Vec3& toEye, const Vec3& toLight) const;
    /// Whether smooth transmission bends rays. It does not in a thin sheet.
    bool bends() const { return !has(kThin); }
    /// Index of refraction on a side; 1 on both sides of a sheet.
    float indexOn(bool front) const { return front || has(kThin) ? 1.0f : ior_; }
    /// Transmitted over incident index of refraction for light that arrives from this side.
    float relativeIndex(bool front) const { return front || has(kThin) ? ior_ : 1.0f / ior_; }
    /// Share of the rays along `direction` (of any length) that pass a pane straight, as if it were not there; the same
    /// from both sides. The lobes describe the other rays. (theory.md, "Panes")
    float passing(const Vec3& direction) const;
    /// Whether light may pass through.
    bool transmits() const { return has(kGlass | kThrough); }
    /// Whether the Smooth event reflects by a diffuse base or sheen, and by rough lobes.
    bool isDiffuse() const { return has(kDiffuse | kSheen); }
    bool isGlossy() const { return has(kRoughLayers | kRoughGlass) || clearcoatAlpha_ > 0.0f; }
    /// The same for transmission in the Smooth event.
    bool transmitsDiffusely() const { return has(kThrough); }
    bool transmitsGlossily() const { return has(kRoughGlass); }
    /// The part of evaluate().f that the diffuse base and the sheen scatter. The rest is glossy.
    Rgb diffusePart(const Vec3& toEye, const Vec3& toLight) const;
    /// Whether all lobes are narrow.
    bool isNarrow() const { return !has(kWide) && alpha_ < kNarrowAlpha; }
    /// Whether it is nearly smooth glass: it transmits by one narrow isotropic lobe.
    bool refractsNarrowly() const {
        return isNarrow() && has(kRoughGlass) && !has(kBrushed | kOwnCoatNormal);
    }
    /// alpha of that lobe.
    float narrowAlpha() const { return alpha_; }
    bool isBlack() const { return !has(kWide | kLayers | kGlass) && !(clearcoat_ > 0.0f); }
    /// Upper estimate of the albedo, the same from both sides, for Russian roulette.
    float survivalAlbedo() const;
    /// Sum of diffuse and specular colour, for the image layer albedo.*.
    Rgb layerAlbedo() const;

    Vec3 ng() const { return ng_; }
    Vec3 ns() const { return ns_; }
    /// Whether the delta event with these directions is about ng and not about ns. False for straight transmission,
    /// which belongs to both.
    bool isAboutNg(const Vec3& toEye, const Vec3& toLight, ScatterEvent event) const;

  private:
    static constexpr float kNarrowAlpha = 0.1f;
    // Which lobes exist. Layers are coat and metal, which share alpha, half vector and density.
    enum Flag : std::uint16_t {
        kDiffuse = 1,
        kCoat = 2,
        kMetal = 4,
        kLayers = kCoat | kMetal,
        kGlass = 8,
        kThin = 16,
        kRoughLayers = 32,  ///< coat and metal have a density
        kRoughGlass = 64,
        kOneLobe = 128,  ///< exactly one of diffuse, layers, glass, and nothing else: no choice
        kThrough = 256,  ///< the diffuse base also transmits
        kSheen = 512,
        kBrushed = 1024,        ///< alpha depends on the direction
        kOwnCoatNormal = 2048,  ///< the clearcoat has its own normal
        kWide = kDiffuse | kThrough | kSheen,
    };

    /// Probabilities of the lobes given the one known direction, and the shares of light that
    /// layers leave to what is under them.
    struct Choice {
        float diffuse = 0;  ///< base and sheen: cosine-distributed on the same side
        float through = 0;  ///< cosine-distributed on the other side
        float layers = 0, glass = 0, clearcoat = 0;
        float open = 1;   ///< 1 - specular E(mu)
        float sheen = 0;  ///< E(mu) of a white sheen
        float bare = 1;   ///< share that the sheen leaves
        float under = 1;  ///< 1 - clearcoat E(mu) of the clearcoat
    };
    /// Share that the clearcoat lets through to any base that is not diffuse, for both directions
    /// together. It is the minimum over the two: no base returns more than reaches it, and a mirror
    /// returns all of it.
    static float underCoat(const Choice& eye, const Choice& light) {
        return eye.under < light.under ? eye.under : light.under;
    }
    /// The same for the sheen over any base.
    static float underSheen(const Choice& eye, const Choice& light) {
        return eye.bare < light.bare ? eye.bare : light.bare;
    }
    static float through(const Choice& eye, const Choice& light) {
        return underCoat(eye, light) * underSheen(eye, light);
    }
    /// The signed cosines of a pair of directions about both normals.
    struct Cosines {
        float eyeG, lightG, eyeS, lightS;
        bool reflects() const { return (eyeG > 0) == (lightG > 0); }
        /// Whether the light is not grazing about ns and on the same side as about ng.
        bool lightSeen() const {
            return (std::abs(lightS) >= kMinCosine) & (lightG * lightS > 0.0f);
        }
    };
    /// A pair of directions in relation to the normal n, for the lobes about n.
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
    /// Whether it is diffuse only: it has no lobes about ng.
    bool isLambert() const { return has(kDiffuse) && has(kOneLobe); }
    /// False if the pair is grazing and scatters nothing.
    bool makeCosines(const Vec3& toEye, const Vec3& toLight, Cosines& c) const {
        c.eyeG = dot(toEye, ng_);
        c.lightG = dot(toLight, ng_);
        // Computed from the difference of the normals: exactly equal where the normals are.
        const Vec3 tilt = ns_ - ng_;
        c.eyeS = c.eyeG + dot(toEye, tilt);
        c.lightS = c.lightG + dot(toLight, tilt);
        // Bitwise for a single branch. NaN fails every comparison.
        return (std::abs(c.eyeG) >= kMinCosine) & (std::abs(c.lightG) >= kMinCosine);
    }
    /// evaluate() of a diffuse lobe alone. Inline, because most of the time is spent here.
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
    /// f of a diffuse base of this colour.
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
    /// The reflection lobe of layers and glass.
    struct Lobe;
    Lobe baseLobe(const Vec3& toEye, const Vec3& toLight, const Pair& pair) const;
    /// The grain of a brushed surface for lobes about the normal n.
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

    /// Reflection and transmission of smooth glass; for a pane, of the rays that stop.
    struct Interface {
        float reflected;  ///< reflectance
        Rgb transmitted;  ///< transmittance, for panes only
        float pmf;        ///< probability of a reflection
    };
    /// For this cosine on a side with this relative index.
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

    // At most 128 bytes, because every path vertex holds a Bsdf.
    const AlbedoTable* table_ = nullptr;  ///< only for a rough coat over a diffuse base
    Vec3 ng_, ns_;
    Rgb baseColor_;
    float alpha_ = 0;
    float ior_ = 1;      ///< of the glass
    float coatIor_ = 1;  ///< of the coat's brightest channel
    /// By channel, (F0 - F0 of the channel) / (1 - F0): the coat reflects F - tintLoss (1 - F).
    Rgb tintLoss_;
    float plastic_ = 0, metal_ = 0;  ///< mixture weights; glass has the rest
    float specular_ = 0;
    float diffuseScale_ = 0;  ///< plastic / (pi times the mean share that all coats leave)
    float clearcoat_ = 0, clearcoatAlpha_ = 0;
    std::uint16_t flags_ = 0;
    std::uint8_t alphaIndex_ : 7 = 0;  ///< AlbedoTable::AlphaPosition
    std::uint8_t isPane_ : 1 = 0;
    std::uint16_t alphaFraction_ = 0;
    float diffuseThrough_ = 0;  ///< share of the diffuse base's light that is transmitted
    PackedColor throughColor_, sheenColor_;
    PackedUnit sheenRoughness_;
    PackedUnit alphaAlong_;  ///< along the tangent; across it alpha_
    PackedDirection tangent_, coatNormal_;
};
static_assert(sizeof(Bsdf) <= 128);

}  // namespace lacuna

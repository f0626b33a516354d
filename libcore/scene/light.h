// All lights of a scene behind one table: picked by power, sampled as the first vertex of light
// subpaths (y_0), asked for the density of any point or direction on them. (theory.md, "Lights")
//
// A vertex on a light carries:
//   area light     point and normal; pdf: pmf / area                  [area measure]
//   point, spot    point;            pdf: pmf                         [delta position left out]
//   environment    direction;        pdf: pmf * pdfW                  [solid angle]
//   directional    direction;        pdf: pmf                         [delta direction left out]
// `beta` of y_0 is its (spatial) exitance over that density, times its opacity; the emission
// profile f_0(w) = Le(w) / exitance plays the BSDF's part. For lights at infinity the next vertex's
// density is that of a disk that covers the scene, f_0 = 1, and no distance is ever divided by.
//
// Exitances are in units of unit(), which is 1 for all but extreme scenes: what a path carries is
// the power of the lights times densities, and lights of 1e37 W/m^2 leave a float no room for that.
// A contribution goes back into the file's units at the very end, by inFileUnits().
//
// guidedBy() gives the same lights with other densities: which light, where on it and along which ray
// follow an EmissionGuide. Everything that asks for a density asks here, so that it follows as well.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libcore/base/discrete.h"
#include "libcore/base/rng.h"
#include "libcore/base/sampling.h"
#include "libcore/base/vec.h"
#include "libcore/scene/alpha.h"
#include "libcore/scene/ball_lamp.h"
#include "libcore/scene/description.h"
#include "libcore/scene/emission_guide.h"
#include "libcore/scene/environment.h"
#include "libcore/scene/lamp_tree.h"
#include "libcore/scene/ray.h"

namespace lacuna {

enum class LightKind : std::uint8_t { Area, Point, Spot, Directional, Environment };

/// A world-space triangle that emits, from its front (counter-clockwise) side or from both.
struct EmissiveTriangle {
    std::array<Vec3, 3> corners;
    std::array<Vec2, 3> uvs;
    Rgb radiance;  ///< factor; times the texture where there is one
    const Texture* texture = nullptr;
    std::optional<TriangleAlpha> alpha;  ///< where some of its points may not be there
    bool twoSided = false;
    bool hiddenFromCamera = false;
    std::uint32_t material = kNone;
};

/// Where y_0 is: what the density of a ray from there depends on.
struct LightPlace {
    std::uint32_t light = kNone;
    Vec3 position{};  ///< at infinity: unit direction from the scene towards the light
    Vec3 ng{};        ///< area lights: the emitting side
    Vec2 uv{};        ///< barycentric (area lights)
};

/// A point (or, at infinity, a direction) on a light: y_0.
struct LightPoint : LightPlace {
    LightKind kind = LightKind::Area;
    float pdf = 0;  ///< in the light's own measure, see above; includes the selection pmf
    /// Area: W/m^2, of what is there; point, spot: W; directional, environment: W/m^2(/sr); per
    /// Lights::unit().
    Rgb exitance;
    /// Share of the rays that find the point there (alpha); the others pass. A light subpath that
    /// begins here carries that share, an eye subpath that ends here has been found by it.
    float opacity = 1.0f;

    /// beta of y_0: what leaves the point over its density; zero where that is zero.
    Rgb throughput() const { return pdf > 0.0f ? exitance * (opacity / pdf) : Rgb{}; }
};

inline bool isInfinite(LightKind k) {
    return k == LightKind::Directional || k == LightKind::Environment;
}
/// Whether an eye walk can run into it.
inline bool isHittable(LightKind k) {
    return k == LightKind::Area || k == LightKind::Environment;
}

class Lights {
  public:
    /// `sceneRadius`: of the bounding sphere about the origin. Environment may be null. Lights
    /// without power are kept (so that indices stay) but never picked.
    Lights(std::vector<EmissiveTriangle> triangles, std::span<const PunctualLight> punctual,
           Vec3d offset, const Environment* environment, float sceneRadius);
    /// These lights, with densities by `guide`, which must fit them (EmissionGuide::check). What
    /// these refer to (textures, the environment) must outlive the result.
    Lights guidedBy(std::shared_ptr<const EmissionGuide> guide) const;
    bool guided() const { return guide_ != nullptr; }
    /// These lights where no walk runs into them: sampleSeenPoint then draws all of a sky.
    Lights withoutHits() const;

    /// No light has any power.
    bool empty() const { return selection_.empty(); }
    std::size_t size() const { return kinds_.size(); }
    LightKind kind(std::uint32_t light) const { return kinds_[light]; }
    /// EmissiveTriangle::corners of an area light.
    const std::array<Vec3, 3>& corners(std::uint32_t light) const {
        return triangles_[light].corners;
    }
    /// What EmissiveTriangle::material was, of an area light.
    std::uint32_t material(std::uint32_t light) const { return triangles_[light].material; }
    const Environment* environment() const { return environment_; }
    std::uint32_t environmentIndex() const { return environmentIndex_; }
    /// Probability of picking this light (proportional to its power, or what the guide says).
    double pmf(std::uint32_t light) const { return selection_.pmf(light); }
    /// What exitances are divided by: a power of two, so that nothing is rounded; 1 where the power
    /// of all lights together is within 2^64 and 2^-64 W.
    double unit() const { return unit_; }
    /// A product of an exitance and anything else.
    Rgb inFileUnits(const Rgb& c) const { return scaled(c, unit_); }

    /// Draws y_0. Not to be called when empty().
    LightPoint samplePoint(Rng& rng) const;

    /// The one point of a light without an extent (point, spot, directional); its pdf is the pmf of
    /// the light.
    LightPoint punctualPoint(std::uint32_t light) const { return pointOn(light, 0.0, {}); }

    /// The same on a light that is picked by what `from` sees of it, a BallLamp as one, and a sky by
    /// what of it is above its mean: as a whole where a guide knows better, and withoutHits(). Its pdf is
    /// still that of samplePoint; `samples` says how many of those points it stands for. Empty where the
    /// draw misses the lamp, or there is nothing to draw.
    struct SeenPoint {
        LightPoint point;
        double samples;
    };
    std::optional<SeenPoint> sampleSeenPoint(const Viewpoint& from, Rng& rng) const;
    /// Its density over that of samplePoint, which is a function of the light alone but on a BallLamp
    /// and in a sky. Of all others with power at least kByPower.
    double seenSamples(const LightPlace& y0, const Viewpoint& from) const;
    /// Share of the points of sampleSeenPoint whose lamp is picked by power all the same: nothing that
    /// the tree does not know costs more than 1 / kByPower of the samples.
    static const double kByPower;
    const LampTree& tree() const { return *tree_; }

    /// The area light at barycentric `uv` of a hit triangle, as if samplePoint had drawn it (pdf
    /// included).
    LightPoint areaPoint(std::uint32_t light, const Vec3& position, const Vec3& ng, Vec2 uv) const {
        const AreaLight& a = area_[light];
        LightPoint p;
        p.light = light;
        p.kind = LightKind::Area;
        p.position = position;
        p.ng = ng;
        p.uv = uv;
        p.pdf = a.pdfA;
        p.exitance = a.textured ? texturedExitance(light, uv) : a.exitance;
        if (a.hasHoles) p.opacity = opacityAt(light, uv);
        if (guide_) p.pdf *= guidedPdf(p);
        return p;
    }
    /// Whether it shines to both sides of its surface.
    bool twoSided(std::uint32_t light) const {
        return light < area_.size() && area_[light].twoSided;
    }
    /// Whether the lens does not see it.
    bool hiddenFromCamera(std::uint32_t light) const {
        return light < triangles_.size() && triangles_[light].hiddenFromCamera;
    }
    /// LightPoint::opacity of a light's point alone.
    float opacity(std::uint32_t light, Vec2 uv) const {
        return light < area_.size() && area_[light].hasHoles ? opacityAt(light, uv) : 1.0f;
    }
    /// The environment in `direction`, likewise. There must be one.
    LightPoint environmentPoint(Vec3 direction) const;

    struct Emission {
        /// f_0(w) = Le(w) / exitance, per projected solid angle (area) or solid angle: the same in
        /// all channels.
        float profile = 0;
        float pdfW = 0;  ///< of w given y_0; at infinity: of the point on the disk (area measure)
    };
    /// Profile and density for light that leaves `y0` along the unit `direction` and comes to `x1`.
    /// At infinity the direction is the light's own and is not read; elsewhere x1 is not.
    Emission emission(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const {
        Emission e = plainEmission(y0.light, y0.ng, direction);
        if (guide_) e.pdfW *= guidedRayPdf(y0, direction, x1);
        return e;
    }
    /// Its profile alone.
    float profile(std::uint32_t light, const Vec3& ng, const Vec3& direction) const {
        return plainEmission(light, ng, direction).profile;
    }

    struct EmissionRay {
        Vec3 origin;
        Vec3 direction;
        Emission emission;
    };
    /// Draws the light subpath's first ray; empty where the draw emits nothing. At infinity `origin`
    /// stands for x_1: where the ray arrives, the density is asked for again.
    std::optional<EmissionRay> sampleEmission(const LightPoint& point, Rng& rng) const;

    /// What the guide's densities are relative to those without one: of the point, with the choice of
    /// its light, and of the ray.
    struct GuidedPdfs {
        float point = 1.0f, ray = 1.0f;
    };
    GuidedPdfs guidedPdfs(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const;
    /// Probability of picking the light without a guide: its share of the power.
    double powerShare(std::uint32_t light) const { return byPower_->pmf(light); }

    /// The square that points of a light are spread over evenly without a guide. Lights without an
    /// extent have none: its corner.
    SquarePoint pointSquare(const LightPlace& y0) const;
    /// The square that rays from a point are spread over evenly without a guide: directions, or at
    /// infinity the disk, on which x1 stands for the ray.
    SquarePoint raySquare(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const;

    /// Radius of the disk from which lights at infinity send their subpaths.
    float diskRadius() const { return diskRadius_; }

  private:
    /// The unit itself may be beyond a float.
    static Rgb scaled(const Rgb& c, double s) {
        return {float(double(c.r) * s), float(double(c.g) * s), float(double(c.b) * s)};
    }
    Environment::Sample sampleSky(double rest, float across, float down,
                                  Environment::Part part) const;
    std::vector<double> powers() const;
    void drawSky(Environment::Part part);
    void chooseUnit(double power);
    void findBalls();
    void sumBalls();
    LampTree makeTree() const;
    LightPoint pointOn(std::uint32_t light, double u, const Rng::Draw& draw,
                       Environment::Part sky = Environment::Part::Whole) const;
    std::optional<LightPoint> seenPointOn(std::uint32_t light, double u, const Rng::Draw& draw,
                                          const Vec3& from) const;
    LightPoint pointOnTriangle(std::uint32_t light, Vec2 uv) const;
    const BallLamp* ballOf(std::uint32_t light) const {
        const std::uint32_t ball = balls_->of[light];
        return ball == kNone ? nullptr : &balls_->lamps[ball];
    }
    /// Whether what is picked depends on who looks.
    bool picksBySight() const { return tree_->chooses() || !balls_->lamps.empty(); }
    double pickSamples(std::uint32_t light, double pmfOfTree) const;
    double pointSamples(const LightPlace& y0, const Vec3& from) const;
    Rgb skyExitance(const Rgb& radiance) const;
    Rgb texturedExitance(std::uint32_t light, Vec2 barycentric) const;
    float opacityAt(std::uint32_t light, Vec2 barycentric) const {
        return triangles_[light].alpha->opacity(barycentric);
    }
    Emission plainEmission(std::uint32_t light, const Vec3& ng, const Vec3& direction) const {
        if (light >= area_.size()) return otherEmission(light, direction);
        const float cosine = dot(ng, direction);
        if (area_[light].twoSided) {
            return {0.5f / kPi, std::fabs(cosine) * (0.5f / kPi)};
        }
        if (cosine <= 0.0f) return {};
        return {1.0f / kPi, cosine / kPi};
    }
    float pdfOfTriangle(std::uint32_t light) const;
    SquarePoint warpPoint(std::uint32_t light, SquarePoint u) const;
    float guidedPdf(const LightPlace& y0) const {
        if (!isHittable(kinds_[y0.light])) return 1.0f;  // no extent: one point
        return float(guide_->at(y0.light, pointSquare(y0)).pdf);
    }
    float guidedRayPdf(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const;
    Emission otherEmission(std::uint32_t light, const Vec3& direction) const;
    Emission spotEmission(const PunctualLight& light, Vec3 direction) const;

    /// What sampling reads of an emissive triangle.
    struct AreaLight {
        Vec3 corner, edge1, edge2;
        Vec3 ng;
        Rgb exitance;  ///< where it has no texture
        double area;
        float pdfA;  ///< selection included
        bool twoSided, textured, hasHoles;
    };

    std::vector<LightKind> kinds_;
    std::vector<EmissiveTriangle> triangles_;  // lights [0, triangles)
    std::vector<AreaLight> area_;              // those again
    std::vector<PunctualLight> punctual_;      // then the punctual ones
    std::vector<Vec3> punctualPosition_, punctualDirection_;
    const Environment* environment_;
    std::uint32_t environmentIndex_ = kNone;             // the last one
    std::shared_ptr<const std::vector<double>> powers_;  // in W, whatever the unit
    std::shared_ptr<const DiscreteDistribution> byPower_;
    DiscreteDistribution selection_;  // that, or what the guide says
    struct Balls {
        std::vector<BallLamp> lamps;
        std::vector<std::uint32_t> of;  ///< by light: its ball; kNone: none
    };
    std::shared_ptr<const Balls> balls_;
    std::vector<double> ballPmfs_;          // probability of picking any of a ball's triangles
    std::shared_ptr<const LampTree> tree_;  // of a ball its first light
    // Of the sky, for next event; what of it that is, and of the probability of all lights.
    Environment::Part skyPart_ = Environment::Part::Whole;
    double skyKept_ = 1.0, kept_ = 1.0;
    std::shared_ptr<const EmissionGuide> guide_;  // null: by power, and evenly
    float diskRadius_;
    double unit_ = 1.0;
};

}  // namespace lacuna

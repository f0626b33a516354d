// All lights of a scene in one table: they are picked by power, sampled as the first vertex of light
// subpaths (y_0), and give the density of any point or direction on them. (theory.md, "Lights")
//
// A vertex on a light stores:
//   area light     point and normal; pdf: pmf / area                  [area measure]
//   point, spot    point;            pdf: pmf                         [delta position left out]
//   environment    direction;        pdf: pmf * pdfW                  [solid angle]
//   directional    direction;        pdf: pmf                         [delta direction left out]
// `beta` of y_0 is its (spatial) exitance over that density, times its opacity. The emission
// profile f_0(w) = Le(w) / exitance takes the place of the BSDF. For lights at infinity, the next
// vertex's density is that of a disk that covers the scene, f_0 = 1, and no distance is divided by.
//
// Exitances are in units of unit(), which is 1 for all but extreme scenes: the throughput of a path
// is the power of the lights times densities, and for lights of 1e37 W/m^2 it would overflow a
// float. inFileUnits() converts a contribution to the file's units at the very end.
//
// guidedBy() returns the same lights with other densities: an EmissionGuide then determines which
// light, point and ray are sampled. All densities come from this class, so that they follow it.
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
    Rgb radiance;  ///< factor, times the texture if there is one
    const Texture* texture = nullptr;
    std::optional<TriangleAlpha> alpha;  ///< if rays can pass through some points
    bool twoSided = false;
    bool hiddenFromCamera = false;
    std::uint32_t material = kNone;
};

/// The place of y_0, on which the density of a ray from it depends.
struct LightPlace {
    std::uint32_t light = kNone;
    Vec3 position{};  ///< at infinity: unit direction from the scene towards the light
    Vec3 ng{};        ///< area lights: the emitting side
    Vec2 uv{};        ///< barycentric (area lights)
};

/// A point (or, at infinity, a direction) on a light: y_0.
struct LightPoint : LightPlace {
    LightKind kind = LightKind::Area;
    float pdf = 0;  ///< in the light's own measure (see above), including the selection pmf
    /// Area: W/m^2, before opacity; point, spot: W; directional: W/m^2; environment: W/m^2/sr. All
    /// are in units of Lights::unit().
    Rgb exitance;
    /// Share of the rays that the point stops (alpha); the others pass. The throughput of a light
    /// subpath that begins here contains this factor. An eye subpath that ends here has met the
    /// point with this probability.
    float opacity = 1.0f;

    /// beta of y_0: exitance times opacity over the density; zero if the density is zero.
    Rgb throughput() const { return pdf > 0.0f ? exitance * (opacity / pdf) : Rgb{}; }
};

inline bool isInfinite(LightKind k) {
    return k == LightKind::Directional || k == LightKind::Environment;
}
/// Whether an eye walk can hit such a light.
inline bool isHittable(LightKind k) {
    return k == LightKind::Area || k == LightKind::Environment;
}

class Lights {
  public:
    /// `offset` is subtracted from positions. `sceneRadius`: radius of the bounding sphere around
    /// the origin. `environment` may be null. Lights without power are kept (so that indices stay)
    /// but never picked.
    Lights(std::vector<EmissiveTriangle> triangles, std::span<const PunctualLight> punctual,
           Vec3d offset, const Environment* environment, float sceneRadius);
    /// These lights with the densities of `guide`, which must fit them (EmissionGuide::check).
    /// Their textures and environment must outlive the result.
    Lights guidedBy(std::shared_ptr<const EmissionGuide> guide) const;
    bool guided() const { return guide_ != nullptr; }
    /// These lights for techniques without hits by walks: sampleSeenPoint then samples the whole
    /// sky.
    Lights withoutHits() const;

    /// Whether no light has any power.
    bool empty() const { return selection_.empty(); }
    std::size_t size() const { return kinds_.size(); }
    LightKind kind(std::uint32_t light) const { return kinds_[light]; }
    /// EmissiveTriangle::corners of an area light.
    const std::array<Vec3, 3>& corners(std::uint32_t light) const {
        return triangles_[light].corners;
    }
    /// EmissiveTriangle::material of an area light.
    std::uint32_t material(std::uint32_t light) const { return triangles_[light].material; }
    const Environment* environment() const { return environment_; }
    std::uint32_t environmentIndex() const { return environmentIndex_; }
    /// Probability of picking this light: proportional to its power, or given by the guide.
    double pmf(std::uint32_t light) const { return selection_.pmf(light); }
    /// The divisor of exitances. It is a power of two, so that nothing is rounded, and 1 if the
    /// total power of the lights is between 2^-64 and 2^64 W.
    double unit() const { return unit_; }
    /// Converts a product of an exitance and other factors to the file's units.
    Rgb inFileUnits(const Rgb& c) const { return scaled(c, unit_); }

    /// Samples y_0. Must not be called when empty().
    LightPoint samplePoint(Rng& rng) const;

    /// The one point of a light without an extent (point, spot, directional); its pdf is the pmf of
    /// the light.
    LightPoint punctualPoint(std::uint32_t light) const { return pointOn(light, 0.0, {}); }

    /// Samples a point for next-event estimation. Lights are picked by the light that `from` may receive from them, and
    /// a BallLamp is picked as one light. Of a sky, only the part above its mean is sampled; with a guide and
    /// withoutHits(), the whole sky is. The point's pdf is still that of samplePoint; `samples` is the ratio of the
    /// true density to that pdf. It is 0 if the sample misses the lamp or nothing can be sampled. `factor` is a
    /// factor of what the point brings (BallLamp::sample).
    struct SeenPoint {
        LightPoint point;
        double samples = 0.0;
        float factor = 1.0f;
    };
    SeenPoint sampleSeenPoint(const Viewpoint& from, Rng& rng) const;
    /// Whether sampleSeenPoint ever gives a point: not under an even sky alone.
    bool samplesSeenPoints() const { return !empty() && kept_ > 0.0; }
    /// The density of sampleSeenPoint over that of samplePoint. It depends on the light alone, except on a BallLamp and
    /// in a sky. For all other lights with power it is at least kByPower.
    double seenSamples(const LightPlace& y0, const Viewpoint& from) const;
    /// Share of the points of sampleSeenPoint whose light is picked by power. It bounds the loss where the tree
    /// misjudges lights: at most 1 / kByPower times as many samples are needed.
    static const double kByPower;
    const LampTree& tree() const { return *tree_; }

    /// The point of an area light at barycentric `uv` of a hit triangle, as if samplePoint had
    /// sampled it (pdf included).
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
    /// Whether the light emits from both sides of its surface.
    bool twoSided(std::uint32_t light) const {
        return light < area_.size() && area_[light].twoSided;
    }
    /// Whether the light is invisible to the lens.
    bool hiddenFromCamera(std::uint32_t light) const {
        return light < triangles_.size() && triangles_[light].hiddenFromCamera;
    }
    /// LightPoint::opacity of a light's point.
    float opacity(std::uint32_t light, Vec2 uv) const {
        return light < area_.size() && area_[light].hasHoles ? opacityAt(light, uv) : 1.0f;
    }
    /// The same for the environment in `direction`. The scene must have one.
    LightPoint environmentPoint(Vec3 direction) const;

    struct Emission {
        /// f_0(w) = Le(w) / exitance, per projected solid angle (area lights) or solid angle; equal
        /// in all channels.
        float profile = 0;
        float pdfW = 0;  ///< of w given y_0; at infinity: of the disk's point (area measure)
    };
    /// Profile and density of a ray that leaves `y0` along the unit `direction` and arrives at
    /// `x1`. At infinity the direction is that of the light and is not read; for other lights x1 is
    /// not read.
    Emission emission(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const {
        Emission e = plainEmission(y0.light, y0.ng, direction);
        if (guide_) e.pdfW *= guidedRayPdf(y0, direction, x1);
        return e;
    }
    /// The profile alone.
    float profile(std::uint32_t light, const Vec3& ng, const Vec3& direction) const {
        return plainEmission(light, ng, direction).profile;
    }

    struct EmissionRay {
        Vec3 origin;
        Vec3 direction;
        Emission emission;
    };
    /// Samples the first ray of a light subpath; empty if the sample emits nothing. At infinity,
    /// `origin` stands in for x_1: the caller must ask for the density again where the ray arrives.
    std::optional<EmissionRay> sampleEmission(const LightPoint& point, Rng& rng) const;

    /// The guide's densities relative to those without a guide: of the point (with the choice of its light) and of the
    /// ray.
    struct GuidedPdfs {
        float point = 1.0f, ray = 1.0f;
    };
    GuidedPdfs guidedPdfs(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const;
    /// Probability of picking the light without a guide: its share of the power.
    double powerShare(std::uint32_t light) const { return byPower_->pmf(light); }

    /// Maps a point of a light to the unit square on which points are uniform without a guide. For
    /// lights without an extent it is the corner (0, 0).
    SquarePoint pointSquare(const LightPlace& y0) const;
    /// Maps a ray from a point to the unit square on which rays are uniform without a guide. The
    /// ray is given by its direction, or at infinity by x1, which determines its point on the disk.
    SquarePoint raySquare(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const;

    /// Radius of the disk from which light subpaths of lights at infinity start.
    float diskRadius() const { return diskRadius_; }

  private:
    /// `s` is double because the unit may be out of the range of float.
    static Rgb scaled(const Rgb& c, double s) {
        return {float(double(c.r) * s), float(double(c.g) * s), float(double(c.b) * s)};
    }
    Environment::Sample sampleSky(double rest, float across, float down,
                                  Environment::SkyPart part) const;
    std::vector<double> powers() const;
    void drawSky(Environment::SkyPart part);
    void chooseUnit(double power);
    void findBalls();
    void sumBalls();
    LampTree makeTree() const;
    LightPoint pointOf(const Rng::Draw& draw) const;
    LightPoint pointOn(std::uint32_t light, double u, const Rng::Draw& draw,
                       Environment::SkyPart sky = Environment::SkyPart::Whole) const;
    SeenPoint seenPointOn(std::uint32_t light, double u, const Rng::Draw& draw,
                          const Vec3& from) const;
    LightPoint pointOnTriangle(std::uint32_t light, Vec2 uv) const {
        const AreaLight& a = area_[light];
        return areaPoint(light, a.corner + a.edge1 * uv.x + a.edge2 * uv.y, a.ng, uv);
    }
    const BallLamp* ballOf(std::uint32_t light) const {
        const std::uint32_t ball = balls_->of[light];
        return ball == kNone ? nullptr : &balls_->lamps[ball];
    }
    /// Whether the choice of a light depends on the viewpoint.
    bool picksBySight() const { return tree_->chooses() || !balls_->lamps.empty(); }
    /// Whether sampleSeenPoint draws as samplePoint does.
    bool picksAsWalks() const { return !picksBySight() && skyPart_ == Environment::SkyPart::Whole; }
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

    /// The data of an emissive triangle that sampling needs.
    struct AreaLight {
        Vec3 corner, edge1, edge2;
        Vec3 ng;
        Rgb exitance;  ///< if it has no texture
        double area;
        float pdfA;  ///< includes the selection pmf
        bool twoSided, textured, hasHoles;
    };

    std::vector<LightKind> kinds_;
    std::vector<EmissiveTriangle> triangles_;  // lights [0, triangles)
    std::vector<AreaLight> area_;              // the same triangles
    std::vector<PunctualLight> punctual_;      // the lights after them
    std::vector<Vec3> punctualPosition_, punctualDirection_;
    const Environment* environment_;
    std::uint32_t environmentIndex_ = kNone;             // the last light, if any
    std::shared_ptr<const std::vector<double>> powers_;  // in W, independent of the unit
    std::shared_ptr<const DiscreteDistribution> byPower_;
    DiscreteDistribution selection_;  // by power, or by the guide
    struct Balls {
        std::vector<BallLamp> lamps;
        std::vector<std::uint32_t> of;  ///< by light: index of its ball, or kNone
    };
    std::shared_ptr<const Balls> balls_;
    std::vector<double> ballPmfs_;          // total pmf of each ball's triangles
    std::shared_ptr<const LampTree> tree_;  // a ball is its first light
    // The part of the sky for next-event estimation, its share of the sky's power, and the share of
    // the probability of all lights that remains.
    Environment::SkyPart skyPart_ = Environment::SkyPart::Whole;
    double skyKept_ = 1.0, kept_ = 1.0;
    std::shared_ptr<const EmissionGuide> guide_;  // null: by power and uniform
    float diskRadius_;
    double unit_ = 1.0;
};

}  // namespace lacuna

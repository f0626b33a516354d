// A chain of mirrors and smooth glass that a ray runs through, and how all of it moves when the
// ray's first direction does: ray differentials [Igehy99]. In double, since a search follows the
// ray to where it meets the light. (theory.md, "Specular chains")
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "libcore/base/vec.h"
#include "libcore/material/bsdf.h"
#include "libcore/scene/scene.h"
#include "libcore/specular/narrow_glass.h"

namespace lacuna {

/// A ray, and its change by each of two parameters.
struct MovingRay {
    Vec3d origin, direction;  ///< direction: unit
    std::array<Vec3d, 2> originBy, directionBy;

    /// From `origin` along the unit `direction`, which the parameters turn: by an angle each, about
    /// axes at a right angle.
    static MovingRay from(const Vec3d& origin, const Vec3d& direction);
    /// Which the parameters move sideways instead, by a metre each.
    static MovingRay parallel(const Vec3d& origin, const Vec3d& direction);
};

/// What happens at a vertex of a chain. Where the shading normal is not the geometric one, some of
/// what an eye sees is scattered about the latter (bsdf.h): an event of its own. ScatterEvent::Smooth: a facet of
/// nearly smooth glass refracts the ray.
struct SpecularEvent {
    ScatterEvent event = ScatterEvent::DeltaReflection;
    bool aboutNg = false;
    bool onClearcoat = false;  ///< of a clearcoat that has normals of its own
    bool operator==(const SpecularEvent&) const = default;
};

struct ChainVertex {
    SurfacePoint point;
    Hit hit;
    std::array<Vec3d, 3> corners;  ///< of its triangle
    Bsdf bsdf;
    SpecularEvent event;
    FacetSlope facet;     ///< of ScatterEvent::Smooth
    Vec3 toEye, toLight;  ///< unit
    /// Share of the radiance from toLight that leaves along toEye, with the square of the index that
    /// refraction changes it by, and with the share of rays that meet the surface at all.
    Rgb through;
    Rgb scatter;  ///< f of the event (bsdf.h)
    /// What the event's generalised densities have beside their probabilities (bsdf.h); where a facet refracts, the
    /// density of toLight if facets are drawn (pdfOfFacet).
    double measure;
};

/// From the eye's side. A value type: searches keep several.
class Chain {
  public:
    static constexpr std::size_t kMost = 6;  ///< vertices

    /// No vertex yet: the ray that it begins with.
    explicit Chain(const MovingRay& first) { restart(first); }
    void restart(const MovingRay& first) {
        first_ = last_ = first;
        size_ = 0;
    }

    std::size_t size() const { return size_; }
    const ChainVertex& operator[](std::size_t i) const { return vertices_[i]; }
    /// Unit, from where the chain begins.
    const Vec3d& firstDirection() const { return first_.direction; }
    const MovingRay& first() const { return first_; }
    /// That leaves the last vertex, or that it begins with.
    const MovingRay& last() const { return last_; }
    /// Of the last vertex; zero where there is none.
    Vec3 lastNormal() const { return size_ > 0 ? vertices_[size_ - 1].point.ng : Vec3{}; }

    /// Goes on at `hit` of last() by `event`. False, with the chain as it was, where the surface has no
    /// such event for this ray. `facet`: of ScatterEvent::Smooth.
    bool extend(const Scene& scene, const Hit& hit, SpecularEvent event, FacetSlope facet = {});
    /// Likewise by one of all events that there are, each with the probability that is its share of the
    /// mean of `through`. `u` in [0, 1).
    bool extend(const Scene& scene, const Hit& hit, double u);
    /// Where last() meets the triangle of another chain's vertex, if it does.
    std::optional<Hit> meetAgain(const ChainVertex& vertex) const;

    /// Of events in turn.
    bool sameEventsAs(const Chain& other) const;

  private:
    struct Step {
        SpecularEvent event;
        FacetSlope facet;
        MovingRay out;
        Vec3 toEye, toLight;
        Rgb through, scatter;
        double measure;
    };
    /// What mirrors and refracts at a hit: all that is there, or one of two layers.
    struct Layer {
        SurfaceShape shape;
        Bsdf bsdf;
        bool isClearcoat;
        float stopped;  ///< share of rays that meet the surface
    };
    bool arriveAt(const Scene& scene, const Hit& hit);
    std::optional<Layer> layerAt(const Scene& scene, const Hit& hit, bool clearcoat) const;
    std::optional<Step> stepAt(const Layer& layer, SpecularEvent event,
                               const FacetSlope& facet = {}) const;
    void take(const Hit& hit, const Layer& layer, const Step& step);

    MovingRay first_, last_;
    std::array<ChainVertex, kMost> vertices_;
    std::size_t size_ = 0;
};

}  // namespace lacuna

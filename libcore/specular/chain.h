// A chain of mirrors and smooth glass that a ray runs through, and how the chain moves with the
// ray's first direction: ray differentials [Igehy99]. All this is in double, since a search follows
// the ray to where it meets the light. (theory.md, "Specular chains")
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

    /// A ray from `origin` along the unit `direction`. The parameters turn the direction, by an
    /// angle each, about axes at a right angle.
    static MovingRay from(const Vec3d& origin, const Vec3d& direction);
    /// Likewise, but the parameters move the ray sideways, by a metre each.
    static MovingRay parallel(const Vec3d& origin, const Vec3d& direction);
};

/// The event at a vertex of a chain. Where the shading normal is not the geometric one, some of what an eye sees is
/// scattered about the latter (bsdf.h). That is an event of its own. ScatterEvent::Smooth means that a facet of nearly
/// smooth glass refracts the ray.
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
    /// Share of the radiance from toLight that leaves along toEye. It contains the squared index by which refraction
    /// changes radiance, and the share of rays that meet the surface at all.
    Rgb through;
    Rgb scatter;  ///< f of the event (bsdf.h)
    /// The factor of the event's generalised densities beside their probabilities (bsdf.h). Where a facet refracts, it
    /// is the density (pdfW) of toLight if facets are drawn (pdfOfFacet).
    double measure;
};

/// A chain, with its vertices in order from the eye's side. It is a value type:
/// searches keep several.
class Chain {
  public:
    static constexpr std::size_t kMost = 6;  ///< vertices

    /// A chain without a vertex, and the ray that it begins with.
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
    /// The ray that leaves the last vertex, or that the chain begins with.
    const MovingRay& last() const { return last_; }
    /// The geometric normal of the last vertex; zero where there is none.
    Vec3 lastNormal() const { return size_ > 0 ? vertices_[size_ - 1].point.ng : Vec3{}; }

    /// Extends the chain by `event` at `hit`, which last() has met. False, with the chain unchanged, where the surface
    /// has no such event for this ray. `facet` is that of ScatterEvent::Smooth.
    bool extend(const Scene& scene, const Hit& hit, SpecularEvent event, FacetSlope facet = {});
    /// Likewise by an event that is drawn by `u` in [0, 1). The probability of each event is its share of the sum of
    /// mean(through).
    bool extend(const Scene& scene, const Hit& hit, double u);
    /// The hit of last() on the triangle of another chain's vertex; empty where it does not
    /// meet the triangle.
    std::optional<Hit> meetAgain(const ChainVertex& vertex) const;

    /// Whether both chains have the same events in the same order.
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
    /// The specular layer at a hit: all that is there, or one of two layers.
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

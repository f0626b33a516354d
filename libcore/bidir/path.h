// Vertices of eye and light subpaths, and how densities change measure between them.
//
// A full path x_0 .. x_k starts on a light and ends on the lens. A subpath is stored
// from its own end: y_0 on the light, z_0 on the lens. (theory.md, "Paths and measures")
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/material/bsdf.h"
#include "libcore/scene/light.h"

namespace lacuna {

enum class VertexKind : std::uint8_t {
    Lens,
    Surface,
    LightSource,  ///< y_0 of a finite light (area, point, spot)
    Infinite,     ///< y_0 of a light at infinity, or where an eye path left the scene
};

/// The label that a method's density knows a vertex by, in one role (ConnectionDensity::labelWalk).
using Label = std::uint32_t;

/// One vertex, as its own subpath's walk left it. Never written after the walk and its labels.
struct PathVertex {
    // Not defaulted: PathVertex() would zero all bytes before it sets the members, which took a
    // quarter of the time that a walk spends on a vertex.
    PathVertex() {}

    Vec3 position;        ///< Infinite: unit direction from the scene towards the light
    Vec3 ng;              ///< zero where there is no surface (lens, point lights, infinity)
    Vec3 toPrevious;      ///< unit, towards the own subpath's previous vertex
    Label asEye = kNone;  ///< label as the end of an eye subpath; kNone: nothing, or not looked up
    Bsdf bsdf;            ///< Surface only
    /// Throughput that arrives AT the vertex, before its BSDF: `beta` of theory.md for light
    /// subpaths, importance over density for eye subpaths. Roulette included.
    Rgb throughput;
    Rgb scatter;            ///< f of the scatter that was sampled here (light: emission profile)
    float pdfA = 0;         ///< density in the own walk, given the previous vertex; no roulette
    float pdfReverseA = 0;  ///< density in the other walk, once the own one has gone two steps on
    float survival = 1;     ///< probability of going on from here, before rr-depth is looked at
    float toPreviousFactor = 0;   ///< |cos at the previous| / d^2: solid angle here to its measure
    std::uint32_t light = kNone;  ///< light of this point, if it emits
    Vec2 lightUv;                 ///< barycentric on it
    Label asLight = kNone;        ///< label as the end of a light subpath, likewise
    /// Material of the surface that the vertex lies on, whose body may absorb (absorption.h). y_0
    /// has it only where something in the scene absorbs.
    std::uint32_t material = kNone;
    std::uint32_t region = kNone;  ///< of the walks' guide; kNone: none (walk_guide.h)
    std::uint32_t object = kNone;  ///< Surface only: index among the scene's objects
    /// Light subpaths, at a vertex behind nothing but glass that is smooth or nearly so: the density of next event
    /// through that glass, relative to an eye walk's without the density of its direction here. Zero where next event
    /// does not find this way (refracted_lamps.h).
    float throughGlass = 0;
    VertexKind kind = VertexKind::Surface;
    ScatterEvent event = ScatterEvent::Smooth;  ///< of the scatter that was sampled here
    std::uint8_t index = 0;                     ///< 0 on the light or the lens
    bool twoSided = false;                      ///< LightSource: its lamp shines to both sides

    bool infinite() const { return kind == VertexKind::Infinite; }
    /// Whether a connection may end here.
    bool connectable() const { return kind != VertexKind::Surface || bsdf.connectable(); }
    /// Whether a surface scatters light elsewhere than into narrow lobes, mirrors and smooth glass. Then walks that
    /// arrive from other directions are worth something here.
    bool scattersWidely() const {
        return kind == VertexKind::Surface && bsdf.connectable() && !bsdf.isNarrow();
    }
};
static_assert(std::is_trivially_copyable_v<PathVertex>);
static_assert(sizeof(PathVertex) == 248);  // pools hold millions of them

/// ng on the side that `direction` leads to.
inline Vec3 sideTowards(const PathVertex& v, const Vec3& direction) {
    return dot(v.ng, direction) < 0.0f ? -v.ng : v.ng;
}
/// ng on the side that a surface's own subpath comes from.
inline Vec3 sideOfPath(const PathVertex& v) {
    return sideTowards(v, v.toPrevious);
}

/// ng on the side that light leaves the vertex to; zero where that is both sides, because a surface
/// transmits or a lamp has no back. For surfaces it is the side that the path lies on, which is the
/// same in either walk's vertex.
inline Vec3 scatteringSide(const PathVertex& v) {
    if (v.kind != VertexKind::Surface) return v.twoSided ? Vec3{} : v.ng;
    if (v.bsdf.transmits()) return {};
    return sideOfPath(v);
}

/// Asks the cache for a vertex that will be looked at soon.
inline void prefetch(const PathVertex& vertex) {
    const char* bytes = reinterpret_cast<const char*>(&vertex);
    for (std::size_t i = 0; i < sizeof(PathVertex); i += 64) __builtin_prefetch(bytes + i);
}

/// y_0 .. y_{s-1} or z_0 .. z_{t-1}; the last vertex is the one that is connected.
using Subpath = std::span<const PathVertex>;

/// Connection::order of connections with the last vertex of an eye subpath z_0 .. z_{t-1}, t >= 2:
/// 1 for the first one, before which there are only mirrors and smooth glass.
inline int connectionOrder(Subpath eyePath) {
    const auto between = eyePath.subspan(1, eyePath.size() - 2);
    return 1 + int(std::ranges::count_if(between,
                                         [](const PathVertex& v) { return !isDelta(v.event); }));
}

/// Geometry of the edge between two vertices; symmetric but for the cosines.
struct Edge {
    Vec3 direction;      ///< unit, from the first vertex to the second
    float toSecond = 0;  ///< density per solid angle at the first -> measure of the second
    float toFirst = 0;   ///< and back
    float geometry = 0;  ///< G without visibility
};

/// Cosine of the area measure at a vertex: 1 where it has no surface. In double, because a float
/// product of grazing directions is off by 1e-4, and weights that read G see that.
inline double measureCosine(const PathVertex& v, const Vec3& direction) {
    // A normal is unit or zero: one comparison tells.
    return lengthSquared(v.ng) == 0.0f ? 1.0 : std::fabs(dot(Vec3d(v.ng), Vec3d(direction)));
}

/// Whether a surface vertex was reached from the other side than the one that `to`, of any length,
/// leads to.
inline bool leadsBehind(const PathVertex& v, const Vec3& to) {
    return dot(v.ng, to) * dot(v.ng, v.toPrevious) < 0.0f;
}

/// The edge from `a` to `b`. At most one of them may be Infinite. Then no distance is divided by,
/// the measure of the infinite vertex is solid angle, and the factor towards the finite vertex is
/// the cosine there (from a disk's area). Coincident points give an edge whose geometry is 0:
/// nothing is carried.
inline Edge edgeBetween(const PathVertex& a, const PathVertex& b) {
    Edge e;
    if (a.infinite() || b.infinite()) {
        const bool toInfinity = b.infinite();
        e.direction = toInfinity ? b.position : -a.position;
        const auto cosine = float(measureCosine(toInfinity ? a : b, e.direction));
        e.toSecond = toInfinity ? 1.0f : cosine;
        e.toFirst = toInfinity ? cosine : 1.0f;
        e.geometry = cosine;
        return e;
    }
    // Differences of floats are exact enough in double only once they are squared: a float square
    // underflows for vertices 1e-20 apart.
    const Vec3d d = Vec3d(b.position) - Vec3d(a.position);
    const double d2 = lengthSquared(d);
    if (!(d2 > 0.0)) return e;
    const double inverse2 = 1.0 / d2;
    e.direction = Vec3(d * (inverse2 * std::sqrt(d2)));  // root and division run at once
    const double cosA = measureCosine(a, e.direction), cosB = measureCosine(b, e.direction);
    e.toSecond = float(cosB * inverse2);
    e.toFirst = float(cosA * inverse2);
    e.geometry = float(cosA * cosB * inverse2);
    return e;
}

/// The vertex as a point on its light with its density and exitance. `vertex.light` must be set.
LightPoint lightPointOf(const Lights& lights, const PathVertex& vertex);

/// Emission profile and density (pdfW) of light that leaves the vertex along `direction` and
/// arrives at `x1`.
inline Lights::Emission emissionOf(const Lights& lights, const PathVertex& vertex,
                                   const Vec3& direction, const Vec3& x1) {
    return lights.emission({vertex.light, vertex.position, vertex.ng, vertex.lightUv}, direction,
                           x1);
}

}  // namespace lacuna

// Full paths from subpaths. A hit, a splat, a connection, a merge, a specular chain or a refraction
// closes a path. Each gives the contribution without its weight, and the FullPath that the weight
// is computed from.
//
// The cheapest tests for paths that carry nothing come first: cosines and the light's own profile.
// Visibility is next, because most connections are blocked where light has to find its way. BSDFs
// follow, which are seldom zero. The FullPath is filled only where there is something to weigh.
// (theory.md, "Paths and measures")
#pragma once

#include <optional>

#include "libcore/bidir/density.h"
#include "libcore/bidir/film.h"
#include "libcore/bidir/full_path.h"
#include "libcore/bidir/mis.h"
#include "libcore/bidir/walk.h"

namespace lacuna {

/// A closed path. `contribution` is f / (p(y) p(z)) of this strategy, without its MIS weight and
/// without the selector's weight (merges: without the kernel, per area at the vertex).
struct Closed {
    Rgb contribution;
    Technique technique;
    Vec2 raster;  ///< splats: where the lens sees it
};

/// One end of a connection as seen from the other end. f is the BSDF, or the emission
/// profile of y_0.
struct EndValue {
    Rgb f;
    float pdfWToOther = 0;  ///< density of the direction to the other end, by this end's own walk
    float pdfWToPrevious = 0;  ///< density of the way back, by the other walk
};
/// EndValue of a light subpath's last vertex. `toEye` is a unit vector, `other` the
/// connection's other end.
inline EndValue lightEnd(const Walker& walker, const PathVertex& y, const Vec3& toEye,
                         const PathVertex& other) {
    if (y.index == 0) {
        const Lights::Emission e = emissionOf(walker.lights(), y, toEye, other.position);
        return {Rgb(e.profile), e.pdfW, 0.0f};
    }
    const BsdfEvaluation e = walker.scattering(y, toEye, y.toPrevious);
    return {e.f, e.pdfWToEye, e.pdfWToLight};
}

/// s = 0: the eye path's last vertex lies on a light. Empty where it emits nothing this way. Fills
/// `path`.
std::optional<Closed> closeHit(const Walker& walker, Subpath eye, FullPath& path);

/// t = 1: the edge from the lens vertex z_0 to a light subpath's last vertex, and where on the film
/// that vertex is seen.
struct LensEdge {
    Edge edge;
    Camera::Projection projection;
};
/// `light` must be connectable. Empty where a splat within `crop` carries nothing, whatever the BSDF.
std::optional<LensEdge> lensEdge(const Walker& walker, const PathVertex& light,
                                 const PathVertex& z0, const PixelRect& crop, RayTally& tally);
/// Closes a splat over that edge. Empty where the BSDF lets nothing through. Fills `path`.
std::optional<Closed> closeSplat(const Walker& walker, Subpath light, const PathVertex& z0,
                                 const LensEdge& open, FullPath& path);

/// s >= 1, t >= 2. The edge between two subpaths' last vertices, from the light's to the eye's;
/// both must be connectable. Empty where a connection carries nothing, whatever the BSDFs.
std::optional<Edge> connectingEdge(const Walker& walker, const PathVertex& light,
                                   const PathVertex& eye, RayTally& tally);
/// Closes a connection over that edge. Empty where the BSDFs let nothing through. Fills `path`.
std::optional<Closed> closeConnection(const Walker& walker, const OpenConnection& open,
                                      FullPath& path);

/// Merges the light subpath's last vertex, a photon, with the eye subpath's last vertex, which must be connectable. x_i
/// is the eye's vertex, and light arrives there as it arrived at the photon. The caller asks onSameSurface. Empty where
/// the BSDF at x_i lets nothing through. Fills `path`.
std::optional<Closed> closeMerge(const Walker& walker, Subpath light, Subpath eye, FullPath& path);

/// A path over a specular chain y_1 .. y_{s-1}, whose events are all deltas, to the eye subpath's
/// last vertex. `atEye` is the value of that vertex's BSDF towards the chain. Fills `path` but for
/// some densities, which no weight asks for.
Closed closeChain(const Walker& walker, Subpath light, Subpath eye, const Rgb& atEye,
                  const Rgb& contribution, FullPath& path);

/// A path through refractions at y_1 .. y_{s-1} to the eye subpath's last vertex. `light` is filled by appendChain,
/// which returns `pdfWToEye`. Fills all of `path` but FullPath::refracted.
Closed closeRefraction(const Walker& walker, Subpath light, float pdfWToEye, Subpath eye,
                       const BsdfEvaluation& atEye, const Rgb& contribution, FullPath& path);

/// Whether the two vertices see each other.
bool connected(const Scene& scene, const PathVertex& light, const PathVertex& eye, RayKind kind,
               RayTally& tally);

}  // namespace lacuna

// Full paths from subpaths: the four ways in which they close a path (hit, splat, connect, merge),
// each giving the contribution without its weight, and the FullPath that the weight is made from.
// In the order of what it costs to find out that a path carries nothing: cosines and the light's
// own profile; visibility, because where light has to find its way most connections are blocked;
// BSDFs, which are seldom zero; the FullPath only where there is something to weigh.
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

/// What leaves a connection's end towards the other: its BSDF, or the emission profile of y_0.
struct EndValue {
    Rgb f;
    float pdfWToOther = 0;  ///< density of the direction to the other end, by this end's own walk
    float pdfWToPrevious = 0;  ///< density of the way back, by the other walk
};
/// That of a light subpath's last vertex; `toEye` is unit, `other` the connection's other end.
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

/// t = 1: the edge from the lens vertex `z0` to a light subpath's last vertex, which must be
/// connectable, and where on the film it is seen. Empty where a splat within `crop` carries
/// nothing, whatever the BSDF.
struct LensEdge {
    Edge edge;
    Camera::Projection projection;
};
std::optional<LensEdge> lensEdge(const Walker& walker, const PathVertex& light,
                                 const PathVertex& z0, const PixelRect& crop, RayTally& tally);
/// Over that edge. Empty where the BSDF lets nothing through. Fills `path`.
std::optional<Closed> closeSplat(const Walker& walker, Subpath light, const PathVertex& z0,
                                 const LensEdge& open, FullPath& path);

/// s >= 1, t >= 2. The edge between two subpaths' last vertices, from the light's to the eye's;
/// both must be connectable. Empty where a connection carries nothing, whatever the BSDFs.
std::optional<Edge> connectingEdge(const Walker& walker, const PathVertex& light,
                                   const PathVertex& eye, RayTally& tally);
/// Over that edge. Empty where the BSDFs let nothing through. Fills `path`.
std::optional<Closed> closeConnection(const Walker& walker, const OpenConnection& open,
                                      FullPath& path);

/// The eye subpath's last vertex, which must be connectable, taken for the photon that the light
/// subpath ends with: x_i is the eye's vertex, reached as the photon was (onSameSurface is not asked
/// here). Empty where its BSDF lets nothing through. Fills `path`.
std::optional<Closed> closeMerge(const Walker& walker, Subpath light, Subpath eye, FullPath& path);

/// A path through a specular chain, y_1 .. y_{s-1} with delta events all, to the eye subpath's last
/// vertex, whose BSDF towards it is `atEye`. Fills `path`, but for densities: no weight asks.
Closed closeChain(const Walker& walker, Subpath light, Subpath eye, const Rgb& atEye,
                  const Rgb& contribution, FullPath& path);

/// A path through refractions, y_1 .. y_{s-1} (appendChain, and the density that it returns), to the eye
/// subpath's last vertex. Fills `path`, but for FullPath::refracted.
Closed closeRefraction(const Walker& walker, Subpath light, float pdfWToEye, Subpath eye,
                       const BsdfEvaluation& atEye, const Rgb& contribution, FullPath& path);

/// Whether the two vertices see each other.
bool connected(const Scene& scene, const PathVertex& light, const PathVertex& eye, RayKind kind,
               RayTally& tally);

}  // namespace lacuna

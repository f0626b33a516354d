// (theory.md, "Paths and measures", "Merging", "Lights")
#include "libcore/bidir/close.h"

#include <algorithm>

#include "libcore/bidir/absorption.h"

namespace lacuna {

namespace {

/// Sets x_i as its walk left it, but for the densities, whose roles depend on the walk.
void fillVertex(FullPath& path, std::size_t i, const PathVertex& v) {
    path.vertex[i] = &v;
    path.survival[i] = v.survival;
    path.delta[i] = isDelta(v.event);
    path.scatter[i] = v.scatter;
    path.asLight[i] = v.asLight;
    path.asEye[i] = v.asEye;
}

/// Sets x_0 .. x_{s-1} from the light subpath.
void fillLightPart(FullPath& path, Subpath light) {
    for (std::size_t i = 0; i < light.size(); ++i) {
        fillVertex(path, i, light[i]);
        path.lightPdfA[i] = light[i].pdfA;
        path.eyePdfA[i] = light[i].pdfReverseA;
    }
}

/// Sets x_k .. x_{k-t+1} from the eye subpath.
void fillEyePart(FullPath& path, Subpath eye) {
    for (std::size_t j = 0; j < eye.size(); ++j) {
        const std::size_t i = std::size_t(path.edges) - j;
        fillVertex(path, i, eye[j]);
        path.lightPdfA[i] = eye[j].pdfReverseA;
        path.eyePdfA[i] = eye[j].pdfA;
    }
}

/// Whether `v` certainly scatters nothing towards `other`. Many connections fail this test, which
/// needs no root and no division. Directions so grazing that rounding could change the answer
/// scatter nothing either (kMinCosine).
bool liesBehind(const PathVertex& v, const PathVertex& other) {
    return v.kind == VertexKind::Surface && !v.bsdf.transmits() &&
           leadsBehind(v, other.infinite() ? other.position : other.position - v.position);
}

/// Whether `v` is on a light that sends nothing along `direction`.
bool isDark(const Lights& lights, const PathVertex& v, const Vec3& direction) {
    return v.index == 0 && !(lights.profile(v.light, v.ng, direction) > 0.0f);
}

/// Sets the number of edges, and how many of them each walk made. No walk made the edge
/// of a connection.
void setEdges(FullPath& path, std::size_t lightVertices, std::size_t eyeVertices) {
    path.edges = int(lightVertices + eyeVertices) - 1;
    path.lightEdges = std::max(0, int(lightVertices) - 1);
    path.eyeEdges = int(eyeVertices) - 1;
    path.photon = nullptr;
}

/// Sets what depends on the light at x_0. Called last, when both walks' densities are set.
void setSource(FullPath& path, const Scene& scene, const Rgb& beta, float opacity) {
    const LightKind kind = scene.lights().kind(path.vertex[0]->light);
    path.absorption = scene.absorption();
    path.sourceBeta = beta;
    path.hittable = isHittable(kind);
    path.splattable = path.hittable;
    path.survival[0] = 1.0f;
    path.delta[0] = false;
    path.eyePdfA[0] *= opacity;  // the other eye walks pass the lamp's point
}
/// Likewise from y_0, whose throughput is known.
void setSource(FullPath& path, const Scene& scene, const PathVertex& y0) {
    setSource(path, scene, y0.throughput, scene.lights().opacity(y0.light, y0.lightUv));
}

/// Whether camera rays pass the surface. Then no other strategy may find it at an eye
/// walk's first step.
bool isHiddenFromCamera(const Scene& scene, const PathVertex& y) {
    if (y.index == 0) return scene.lights().hiddenFromCamera(y.light);
    return scene.description().materials[y.material].hiddenFromCamera;
}

}  // namespace

std::optional<Closed> closeHit(const Walker& walker, Subpath eye, FullPath& path) {
    const PathVertex& z = eye.back();
    if (z.light == kNone || z.index == 0) return std::nullopt;
    const Lights& lights = walker.lights();
    const LightPoint point = lightPointOf(lights, z);
    const Lights::Emission emission =
        lights.emission(point, z.toPrevious, eye[eye.size() - 2].position);
    const Closed closed{z.throughput * point.exitance * emission.profile, int(eye.size()), {}};
    if (isBlack(closed.contribution)) return std::nullopt;

    setEdges(path, 0, eye.size());
    fillEyePart(path, eye);
    path.scatter[0] = Rgb(emission.profile);
    path.asLight[0] = kNone;  // as y_0 it has no predecessor, whatever the walk met behind it
    path.lightPdfA[0] = point.pdf;
    if (path.edges > 1) path.lightPdfA[1] = emission.pdfW * z.toPreviousFactor;
    setSource(path, walker.scene(), point.throughput(), point.opacity);
    return closed;
}

std::optional<LensEdge> lensEdge(const Walker& walker, const PathVertex& y, const PathVertex& z0,
                                 const PixelRect& crop, RayTally& tally) {
    const Lights& lights = walker.lights();
    // A punctual light in the picture itself has no size: no strategy makes that path, so that all
    // methods agree (and no pixel holds a spike that grows with the resolution).
    if (y.index == 0 && !isHittable(lights.kind(y.light))) return std::nullopt;
    if (isHiddenFromCamera(walker.scene(), y)) return std::nullopt;
    const Edge edge = edgeBetween(z0, y);
    if (!(edge.geometry > 0.0f)) return std::nullopt;
    const auto projection = walker.camera().project(z0.position, edge.direction);
    if (!projection || !crop.contains(int(projection->raster.x), int(projection->raster.y)) ||
        liesBehind(y, z0) || isDark(lights, y, -edge.direction) ||
        !connected(walker.scene(), y, z0, RayKind::Splat, tally)) {
        return std::nullopt;
    }
    return LensEdge{edge, *projection};
}

std::optional<Closed> closeSplat(const Walker& walker, Subpath light, const PathVertex& z0,
                                 const LensEdge& open, FullPath& path) {
    const auto& [edge, projection] = open;
    const PathVertex& y = light.back();
    const EndValue end = lightEnd(walker, y, -edge.direction, z0);
    const Rgb through = transmittance(walker.scene().absorption(), z0, edge.direction, y);
    const Closed closed{y.throughput * end.f * through * (edge.geometry * projection.pdfW), 1,
                        projection.raster};
    if (isBlack(closed.contribution)) return std::nullopt;

    setEdges(path, light.size(), 1);
    const int k = path.edges;
    fillLightPart(path, light);
    path.vertex[k] = &z0;
    path.lightPdfA[k] = 0.0f;
    path.eyePdfA[k] = 1.0f;
    path.survival[k] = 1.0f;
    path.delta[k] = path.delta[k - 1] = false;
    path.scatter[k - 1] = end.f;
    path.asEye[k - 1] = kNone;  // its walk labelled it for another predecessor than the lens
    path.eyePdfA[k - 1] = projection.pdfW * edge.toSecond;
    if (k >= 2) path.eyePdfA[k - 2] = end.pdfWToPrevious * y.toPreviousFactor;
    setSource(path, walker.scene(), light[0]);
    return closed;
}

std::optional<Edge> connectingEdge(const Walker& walker, const PathVertex& y, const PathVertex& z,
                                   RayTally& tally) {
    if (liesBehind(y, z) || liesBehind(z, y)) return std::nullopt;
    const Edge edge = edgeBetween(y, z);
    if (!(edge.geometry > 0.0f) || isDark(walker.lights(), y, edge.direction) ||
        !connected(walker.scene(), y, z, RayKind::Connection, tally)) {
        return std::nullopt;
    }
    return edge;
}

std::optional<Closed> closeConnection(const Walker& walker, const OpenConnection& open,
                                      FullPath& path) {
    const auto& [light, eye, edge, lightAsEye, eyeAsLight] = open;
    const PathVertex& y = light.back();
    const PathVertex& z = eye.back();
    const EndValue atLight = lightEnd(walker, y, edge.direction, z);
    const BsdfEvaluation atEye = walker.scattering(z, z.toPrevious, -edge.direction);
    const Rgb through = transmittance(walker.scene().absorption(), y, edge.direction, z);
    const Closed closed{z.throughput * atEye.f * atLight.f * through * y.throughput * edge.geometry,
                        int(eye.size()),
                        {}};
    if (isBlack(closed.contribution)) return std::nullopt;

    const int s = int(light.size());
    setEdges(path, light.size(), eye.size());
    fillLightPart(path, light);
    fillEyePart(path, eye);
    path.delta[s - 1] = path.delta[s] = false;
    path.scatter[s - 1] = atLight.f;
    path.scatter[s] = atEye.f;
    path.asEye[s - 1] = lightAsEye;
    path.asLight[s] = eyeAsLight;
    path.lightPdfA[s] = atLight.pdfWToOther * edge.toSecond;
    path.eyePdfA[s - 1] = atEye.pdfWToLight * edge.toFirst;
    if (s >= 2) path.eyePdfA[s - 2] = atLight.pdfWToPrevious * y.toPreviousFactor;
    if (s + 1 < path.edges) path.lightPdfA[s + 1] = atEye.pdfWToEye * z.toPreviousFactor;
    setSource(path, walker.scene(), light[0]);
    return closed;
}

std::optional<Closed> closeMerge(const Walker& walker, Subpath light, Subpath eye, FullPath& path) {
    const PathVertex& photon = light.back();
    const PathVertex& z = eye.back();
    const BsdfEvaluation at = walker.scattering(z, z.toPrevious, photon.toPrevious);
    const Closed closed{z.throughput * at.f * photon.throughput,
                        Technique(int(eye.size()), Technique::By::Merge),
                        {}};
    if (isBlack(closed.contribution)) return std::nullopt;

    const std::size_t i = light.size() - 1;
    setEdges(path, i, eye.size());
    path.lightEdges = int(i);
    path.photon = &photon;
    fillLightPart(path, light.first(i));
    fillEyePart(path, eye);
    path.delta[i] = false;
    path.scatter[i] = at.f;
    path.asEye[i - 1] = kNone;  // both walks labelled their last vertex for another neighbour
    path.asLight[i] = kNone;
    path.lightPdfA[i] = photon.pdfA;
    path.eyePdfA[i - 1] = at.pdfWToLight * photon.toPreviousFactor;
    if (int(i) + 1 < path.edges) path.lightPdfA[i + 1] = at.pdfWToEye * z.toPreviousFactor;
    setSource(path, walker.scene(), light[0]);
    return closed;
}

Closed closeChain(const Walker& walker, Subpath light, Subpath eye, const Rgb& atEye,
                  const Rgb& contribution, FullPath& path) {
    setEdges(path, light.size(), eye.size());
    fillLightPart(path, light);
    fillEyePart(path, eye);
    path.delta[light.size()] = false;
    path.scatter[light.size()] = atEye;
    setSource(path, walker.scene(), light[0]);
    return {contribution, Technique(int(eye.size()), Technique::By::Chain), {}};
}

Closed closeRefraction(const Walker& walker, Subpath light, float pdfWToEye, Subpath eye,
                       const BsdfEvaluation& atEye, const Rgb& contribution, FullPath& path) {
    setEdges(path, light.size(), eye.size());
    fillLightPart(path, light);
    fillEyePart(path, eye);
    const std::size_t s = light.size();
    const PathVertex& z = eye.back();
    const Edge edge = edgeBetween(light.back(), z);
    path.delta[s] = false;
    path.scatter[s] = atEye.f;
    path.asLight[s] = kNone;  // its walk labelled it for another predecessor
    path.lightPdfA[s] = pdfWToEye * edge.toSecond;
    path.eyePdfA[s - 1] = atEye.pdfWToLight * edge.toFirst;
    if (int(s) + 1 < path.edges) path.lightPdfA[s + 1] = atEye.pdfWToEye * z.toPreviousFactor;
    setSource(path, walker.scene(), light[0]);
    return {contribution, Technique(int(eye.size()), Technique::By::Refraction), {}};
}

bool connected(const Scene& scene, const PathVertex& light, const PathVertex& eye, RayKind kind,
               RayTally& tally) {
    if (light.infinite()) {
        return scene.visibleToInfinity(eye.position, eye.ng, light.position, kind, tally);
    }
    return scene.visible(eye.position, eye.ng, light.position, light.ng, kind, tally);
}

}  // namespace lacuna

#include "libcore/bidir/walk.h"

#include <cmath>
#include <memory>
#include <new>

#include "libcore/bidir/absorption.h"

namespace lacuna {

bool Walker::sampleLight(Rng& rng, PathVertex& out) const {
    const Lights& lights = scene_.lights();
    if (lights.empty()) return false;
    const LightPoint p = lights.samplePoint(rng);
    if (!(p.pdf > 0.0f)) return false;
    std::construct_at(&out);
    out.kind = isInfinite(p.kind) ? VertexKind::Infinite : VertexKind::LightSource;
    out.position = p.position;
    out.ng = p.ng;
    out.light = p.light;
    out.lightUv = p.uv;
    if (p.kind == LightKind::Area && !scene_.absorption().empty()) {
        out.material = scene_.materialOf(p.light);
    }
    out.pdfA = p.pdf;
    out.throughput = p.exitance * (1.0f / p.pdf);
    return true;
}

PathVertex Walker::sampleLens(Rng& rng) const {
    PathVertex z0;
    z0.kind = VertexKind::Lens;
    // The pinhole needs no numbers; the draw keeps the stream's layout the same for every lens.
    const float u1 = rng.uniform(), u2 = rng.uniform();
    z0.position = camera_.sampleLens({u1, u2});
    z0.pdfA = 1.0f;  // the lens's density is the same in every strategy and cancels
    z0.throughput = Rgb(1.0f);
    return z0;
}

void Walker::traceLight(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const {
    out.clear();
    PathVertex y0;
    if (!sampleLight(rng, y0)) return;
    out.push_back(y0);
    if (limits_.maxDepth < 2 || isBlack(y0.throughput)) return;

    const LightPoint point = lightPointOf(scene_.lights(), y0);
    const auto ray = scene_.lights().sampleEmission(point, rng);
    if (!ray) return;
    out[0].scatter = ray->emission.profile;
    const auto cosine = float(measureCosine(y0, ray->direction));
    goOn(Side::Light, ray->origin, ray->direction, ray->emission.pdfW,
         y0.throughput * ray->emission.profile * (cosine / ray->emission.pdfW),
         std::size_t(limits_.maxDepth), rng, tally, out);
}

void Walker::traceEye(Vec2 raster, Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const {
    out.clear();
    out.push_back(sampleLens(rng));
    const Camera::Direction d = camera_.directionAt(out[0].position, raster);
    goOn(Side::Eye, out[0].position, d.direction, d.pdfW, Rgb(1.0f),
         std::size_t(limits_.maxDepth) + 1, rng, tally, out);
}

void Walker::addSurface(const SurfacePoint& point, const Vec3& direction, float pdfW,
                        const Rgb& throughput, std::vector<PathVertex>& out) const {
    PathVertex& v = out.emplace_back();
    const PathVertex& previous = out[out.size() - 2];
    v.kind = VertexKind::Surface;
    v.index = std::uint16_t(out.size() - 1);
    v.position = point.position;
    v.ng = point.ng;
    v.toPrevious = -direction;
    ::new (&v.bsdf) Bsdf(scene_.bsdfAt(point));  // in place: 96 bytes are worth not copying
    v.light = point.light;
    v.lightUv = point.barycentric;
    v.material = point.material;
    v.survival = v.bsdf.survivalAlbedo();
    v.throughput = throughput * transmittance(scene_.absorption(), previous, direction, v);

    const double cosine = measureCosine(v, direction);
    if (previous.infinite()) {
        v.pdfA = float(double(pdfW) * cosine);  // density on the disk -> area here
        v.toPreviousFactor = 1.0f;
        return;
    }
    const double inverse2 = 1.0 / lengthSquared(Vec3d(point.position) - Vec3d(previous.position));
    v.pdfA = float(double(pdfW) * cosine * inverse2);
    v.toPreviousFactor = float(measureCosine(previous, direction) * inverse2);
}

void Walker::goOn(Side side, Vec3 origin, Vec3 direction, float pdfW, Rgb throughput,
                  std::size_t maxVertices, Rng& rng, RayTally& tally,
                  std::vector<PathVertex>& out) const {
    RayKind kind = side == Side::Eye ? RayKind::Camera : RayKind::LightWalk;
    Vec3 ng = out.back().ng;
    SurfacePoint hit;
    while (out.size() < maxVertices) {
        const bool isHit = scene_.intersect(origin, ng, direction, kind, tally, hit);
        if (side == Side::Eye) kind = RayKind::EyeWalk;
        if (!isHit) {
            if (side == Side::Eye && scene_.environment()) {
                PathVertex& v = out.emplace_back();
                const PathVertex& previous = out[out.size() - 2];
                v.kind = VertexKind::Infinite;
                v.index = std::uint16_t(out.size() - 1);
                v.position = direction;
                v.toPrevious = -direction;
                v.light = scene_.lights().environmentIndex();
                v.throughput = throughput;
                v.pdfA = pdfW;
                v.toPreviousFactor = float(measureCosine(previous, direction));
            }
            return;
        }
        if (hit.position == out.back().position) return;  // no distance, no measure
        addSurface(hit, direction, pdfW, throughput, out);
        if (out.size() == maxVertices) return;

        PathVertex& v = out.back();
        float survival = 1.0f;
        if (int(v.index) >= limits_.rouletteDepth) {
            survival = v.survival;
            if (survival < 1.0f && rng.uniform() >= survival) return;
        }
        const float uLobe = rng.uniform(), u1 = rng.uniform(), u2 = rng.uniform();
        const std::optional<BsdfSample> sample = v.bsdf.sample(side, v.toPrevious, uLobe, u1, u2);
        if (!sample) return;
        const BsdfEvaluation& e = sample->evaluation;
        const float forward = side == Side::Eye ? e.pdfWToLight : e.pdfWToEye;
        const float reverse = side == Side::Eye ? e.pdfWToEye : e.pdfWToLight;
        if (!(forward > 0.0f)) return;
        throughput =
            v.throughput * (e.f * (std::fabs(dot(sample->to, v.ng)) / (forward * survival)));
        if (isBlack(throughput)) return;

        v.scatter = e.f;
        v.event = sample->event;
        out[out.size() - 2].pdfReverseA = reverse * v.toPreviousFactor;
        origin = v.position;
        ng = v.ng;
        direction = sample->to;
        pdfW = forward;
    }
}

}  // namespace lacuna

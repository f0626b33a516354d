#include "libcore/bidir/walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>

#include "libcore/bidir/absorption.h"
#include "libcore/bidir/sampler.h"

namespace lacuna {

namespace {
/// Walks that are traced in turn. More of them do not fit into the processor's first cache.
constexpr std::size_t kTogether = 8;

Viewpoint viewpointOf(const PathVertex& eye) {
    return {eye.position, scatteringSide(eye)};
}
}  // namespace

bool Walker::sampleLight(Rng& rng, PathVertex& out) const {
    return sampleLightPoint(rng, out).has_value();
}

std::optional<LightPoint> Walker::sampleLightPoint(Rng& rng, PathVertex& out) const {
    if (lights_.empty()) return std::nullopt;
    const LightPoint p = lights_.samplePoint(rng);
    if (!setLightVertex(p, out)) return std::nullopt;
    return p;
}

LightSampler::Seen Walker::sampleSeenLight(const PathVertex& eye, Rng& rng, PathVertex& out) const {
    const Lights::SeenPoint seen = lights_.sampleSeenPoint(viewpointOf(eye), rng);
    if (!(seen.samples > 0.0) || !setLightVertex(seen.point, out)) return {};
    return {seen.samples, seen.factor};
}

bool Walker::placeLight(std::uint32_t light, double pmf, PathVertex& out) const {
    LightPoint point = lights_.punctualPoint(light);
    point.pdf = float(pmf);
    return setLightVertex(point, out);
}

double Walker::seenSamples(const PathVertex& light, const PathVertex& eye) const {
    return lights_.seenSamples({light.light, light.position, light.ng, light.lightUv},
                               viewpointOf(eye));
}

/// Makes y_0 of the point. False where it is dark.
bool Walker::setLightVertex(const LightPoint& p, PathVertex& out) const {
    const Rgb throughput = p.throughput();
    if (isBlack(throughput)) return false;
    std::construct_at(&out);
    out.kind = isInfinite(p.kind) ? VertexKind::Infinite : VertexKind::LightSource;
    out.position = p.position;
    out.ng = p.ng;
    out.light = p.light;
    out.lightUv = p.uv;
    out.twoSided = lights_.twoSided(p.light);
    if (p.kind == LightKind::Area && !scene_.absorption().empty()) {
        out.material = lights_.material(p.light);
    }
    out.pdfA = p.pdf;
    out.throughput = throughput;
    return true;
}

PathVertex Walker::sampleLens(Rng& rng) const {
    PathVertex z0;
    z0.kind = VertexKind::Lens;
    // The pinhole needs no numbers; the draw keeps the stream's layout the same for every lens.
    const Rng::Pair u = rng.evenPair();
    z0.position = camera_.sampleLens({u.u1, u.u2});
    z0.pdfA = 1.0f;  // the lens's density is the same in every strategy and cancels
    z0.throughput = Rgb(1.0f);
    return z0;
}

std::optional<Walk> Walker::startLight(Rng& rng, std::vector<PathVertex>& out) const {
    out.clear();
    PathVertex y0;
    const std::optional<LightPoint> point = sampleLightPoint(rng, y0);
    if (!point) return std::nullopt;
    out.push_back(y0);
    if (limits_.maxDepth < 2) return std::nullopt;

    const auto ray = lights_.sampleEmission(*point, rng);
    if (!ray) return std::nullopt;
    out[0].scatter = Rgb(ray->emission.profile);
    Walk walk{Side::Light, &out, &rng, ray->origin, y0.ng, ray->direction, 0.0f, {}};
    setOut(walk, ray->emission);
    return walk;
}

/// Sets density and throughput of the first ray of a light walk.
void Walker::setOut(Walk& walk, const Lights::Emission& emission) {
    const PathVertex& y0 = walk.path->front();
    const auto cosine = float(measureCosine(y0, walk.direction));
    walk.pdfW = emission.pdfW;
    walk.throughput = y0.throughput * emission.profile * (cosine / emission.pdfW);
}

Walk Walker::startEye(Vec2 raster, Rng& rng, std::vector<PathVertex>& out) const {
    out.clear();
    out.push_back(sampleLens(rng));
    const Camera::Direction d = camera_.directionAt(out[0].position, raster);
    return {Side::Eye, &out, &rng, out[0].position, out[0].ng, d.direction, d.pdfW, Rgb(1.0f)};
}

void Walker::traceLight(Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const {
    if (auto walk = startLight(rng, out)) finishAlone(*walk, tally);
}

void Walker::traceEye(Vec2 raster, Rng& rng, RayTally& tally, std::vector<PathVertex>& out) const {
    Walk walk = startEye(raster, rng, out);
    finishAlone(walk, tally);
}

void Walker::addSurface(const SurfacePoint& point, const Vec3& direction, float pdfW,
                        const Rgb& throughput, std::vector<PathVertex>& out) const {
    PathVertex& v = out.emplace_back();
    const PathVertex& previous = out[out.size() - 2];
    v.kind = VertexKind::Surface;
    v.index = std::uint8_t(out.size() - 1);
    v.position = point.position;
    v.ng = point.ng;
    v.toPrevious = -direction;
    ::new (&v.bsdf) Bsdf(scene_.bsdfAt(point));  // in place: 128 bytes are worth not copying
    v.light = point.light;
    v.lightUv = point.barycentric;
    v.material = point.material;
    v.object = point.object;
    v.survival = v.bsdf.survivalAlbedo();
    v.region = regionOf(v);
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

void Walker::finish(std::span<Walk> walks, RayTally& tally) const {
    // Where a walk has to wait for texels, others go on meanwhile. Where none waits, taking turns
    // only makes successive rays less coherent.
    if (!scene_.hasFarTextures()) {
        for (Walk& walk : walks) finishAlone(walk, tally);
        return;
    }
    while (!walks.empty()) {
        const std::size_t count = std::min(kTogether, walks.size());
        finishTogether(walks.first(count), tally);
        walks = walks.subspan(count);
    }
}

void Walker::finishAlone(Walk& walk, RayTally& tally) const {
    SurfacePoint point;
    do {
        const std::optional<Hit> hit = nextHit(walk, tally);
        if (!hit) return;
        scene_.surfaceAt(*hit, point);
    } while (scatter(walk, point));
}

/// Traces at most kTogether walks, a step of each in turn.
void Walker::finishTogether(std::span<Walk> walks, RayTally& tally) const {
    std::array<Walk*, kTogether> going;
    std::array<std::optional<Hit>, kTogether> hits;
    std::array<SurfacePoint, kTogether> points;
    std::size_t count = 0;
    for (Walk& walk : walks) going[count++] = &walk;
    while (count > 0) {
        std::size_t found = 0;
        for (std::size_t i = 0; i < count; ++i) {
            hits[found] = nextHit(*going[i], tally);
            if (hits[found]) going[found++] = going[i];
        }
        for (std::size_t i = 0; i < found; ++i) scene_.surfaceAt(*hits[i], points[i]);
        count = 0;
        for (std::size_t i = 0; i < found; ++i) {
            if (scatter(*going[i], points[i])) going[count++] = going[i];
        }
    }
}

/// The walk's next hit. An eye walk that leaves the scene gets a vertex on the environment.
std::optional<Hit> Walker::nextHit(const Walk& walk, RayTally& tally) const {
    std::vector<PathVertex>& out = *walk.path;
    const RayKind kind = walk.side == Side::Light ? RayKind::LightWalk
                         : out.size() == 1        ? RayKind::Camera
                                                  : RayKind::EyeWalk;
    const std::optional<Hit> hit = scene_.trace(walk.origin, walk.ng, walk.direction, kind, tally);
    if (hit || walk.side == Side::Light || !scene_.environment()) return hit;
    PathVertex& v = out.emplace_back();
    const PathVertex& previous = out[out.size() - 2];
    v.kind = VertexKind::Infinite;
    v.index = std::uint8_t(out.size() - 1);
    v.position = walk.direction;
    v.toPrevious = -walk.direction;
    v.light = lights_.environmentIndex();
    v.throughput = walk.throughput;
    v.pdfA = walk.pdfW;
    v.toPreviousFactor = float(measureCosine(previous, walk.direction));
    return hit;
}

/// Adds the vertex and draws the walk's next direction. False where the walk ends.
bool Walker::scatter(Walk& walk, const SurfacePoint& hit) const {
    std::vector<PathVertex>& out = *walk.path;
    if (hit.position == out.back().position) return false;  // no distance, no measure
    // The density on the disk is looked up by x_1, which every walk of this path knows. Rounding
    // may have moved the ray over the edge of a cell.
    if (out[0].infinite() && out.size() == 1 && lights_.guided()) {
        setOut(walk, emissionOf(lights_, out[0], walk.direction, hit.position));
    }
    addSurface(hit, walk.direction, walk.pdfW, walk.throughput, out);
    const std::size_t maxVertices =
        std::size_t(limits_.maxDepth) + (walk.side == Side::Eye ? 1 : 0);
    if (out.size() == maxVertices) return false;

    PathVertex& v = out.back();
    Rng& rng = *walk.rng;
    const float survival = survivalAt(v);
    rng.toDimension(dimension::ofWalk(v.index));
    if (survival < 1.0f && rng.evenUniform() >= survival) return false;
    rng.toDimension(dimension::ofWalk(v.index) + 1);
    const std::optional<BsdfSample> sample = sampleDirection(walk.side, v, rng);
    if (!sample) return false;
    const BsdfEvaluation& e = sample->evaluation;
    const float forward = walk.side == Side::Eye ? e.pdfWToLight : e.pdfWToEye;
    const float reverse = walk.side == Side::Eye ? e.pdfWToEye : e.pdfWToLight;
    if (!(forward > 0.0f)) return false;
    walk.throughput =
        v.throughput * (e.f * (std::fabs(dot(sample->to, v.ng)) / (forward * survival)));
    if (isBlack(walk.throughput) && !walk.lends) return false;

    v.scatter = e.f;
    v.event = sample->event;
    out[out.size() - 2].pdfReverseA = reverse * v.toPreviousFactor;
    walk.origin = v.position;
    walk.ng = v.ng;
    walk.direction = sample->to;
    walk.pdfW = forward;
    return true;
}

/// Draws the walk's direction from `v`: by the guide as often as its share says, else by the BSDF.
std::optional<BsdfSample> Walker::sampleDirection(Side side, const PathVertex& v, Rng& rng) const {
    float uLobe = rng.evenUniform();
    const Rng::Pair u = rng.evenPair();
    if (v.region == kNone) return v.bsdf.sample(side, v.toPrevious, uLobe, u.u1, u.u2);
    const WalkGuide::Region& region = guide()->region(v.region);
    const float share = region.of(side).share;
    const bool eye = side == Side::Eye;
    if (uLobe < share) {
        const Vec3 to = region.sample(side, u.u1, u.u2);
        return BsdfSample{to, ScatterEvent::Smooth,
                          scattering(v, eye ? v.toPrevious : to, eye ? to : v.toPrevious)};
    }
    uLobe = std::min((uLobe - share) / (1.0f - share), 0x1.fffffep-1f);
    std::optional<BsdfSample> sample = v.bsdf.sample(side, v.toPrevious, uLobe, u.u1, u.u2);
    if (sample) {
        const Vec3& to = sample->to;
        guide()->mix(v.region, eye ? v.toPrevious : to, eye ? to : v.toPrevious, sample->event,
                     sample->evaluation);
    }
    return sample;
}

}  // namespace lacuna

#include "libcore/specular/chain.h"

#include <cmath>

namespace lacuna {

namespace {

/// Two unit vectors at a right angle to the unit `n` and to each other.
std::array<Vec3d, 2> across(const Vec3d& n) {
    const Vec3d other = std::fabs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d s = normalize(cross(n, other));
    return {s, cross(n, s)};
}

/// A place in space, and its change by the two parameters.
struct MovingPlace {
    Vec3d at;
    std::array<Vec3d, 2> by;
};

/// Where the ray meets the plane of a triangle.
MovingPlace meet(const MovingRay& ray, const SurfaceShape& shape) {
    const double towards = dot(ray.direction, shape.ng);
    const double t = dot(shape.corners[0] - ray.origin, shape.ng) / towards;
    MovingPlace meeting{ray.origin + ray.direction * t, {}};
    for (std::size_t i = 0; i < 2; ++i) {
        const Vec3d moved = ray.originBy[i] + ray.directionBy[i] * t;
        meeting.by[i] = moved - ray.direction * (dot(moved, shape.ng) / towards);
    }
    return meeting;
}

/// The unit shading normal at a point of the triangle's plane.
MovingNormal normalAt(const SurfaceShape& shape, const MovingPlace& point) {
    const auto& [c0, c1, c2] = shape.corners;
    const auto& [n0, n1, n2] = shape.normals;
    const Vec3d u = c1 - c0, v = c2 - c0, turnU = n1 - n0, turnV = n2 - n0;
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
    const double inverse = 1.0 / (uu * vv - uv * uv);
    // Barycentric coordinates are linear in the point.
    const auto across = [&](const Vec3d& way) {
        const double alongU = dot(way, u), alongV = dot(way, v);
        return turnU * ((vv * alongU - uv * alongV) * inverse) +
               turnV * ((uu * alongV - uv * alongU) * inverse);
    };
    const Vec3d sum = n0 + across(point.at - c0);
    const double scale = 1.0 / length(sum);
    MovingNormal normal{sum * scale, {}};
    for (std::size_t i = 0; i < 2; ++i) {
        const Vec3d moved = across(point.by[i]) * scale;
        normal.by[i] = moved - normal.at * dot(normal.at, moved);
    }
    return normal;
}

/// The ray with its direction mirrored; the origin stays.
MovingRay mirroredBy(const MovingNormal& normal, const MovingRay& ray) {
    MovingRay mirrored = ray;
    const double along = dot(ray.direction, normal.at);
    mirrored.direction = ray.direction - normal.at * (2.0 * along);
    for (std::size_t i = 0; i < 2; ++i) {
        const double alongBy =
            dot(ray.directionBy[i], normal.at) + dot(ray.direction, normal.by[i]);
        mirrored.directionBy[i] =
            ray.directionBy[i] - normal.at * (2.0 * alongBy) - normal.by[i] * (2.0 * along);
    }
    return mirrored;
}

bool isSpecular(const Bsdf& bsdf) {
    return bsdf.has(ScatterEvent::DeltaReflection) || bsdf.has(ScatterEvent::DeltaTransmission);
}
bool hasEvent(const Bsdf& bsdf, ScatterEvent event) {
    return isDelta(event) ? bsdf.has(event) : bsdf.refractsNarrowly();
}

}  // namespace

MovingRay MovingRay::from(const Vec3d& origin, const Vec3d& direction) {
    return {origin, direction, {}, across(direction)};
}

MovingRay MovingRay::parallel(const Vec3d& origin, const Vec3d& direction) {
    return {origin, direction, across(direction), {}};
}

std::optional<Chain::Step> Chain::stepAt(const Layer& layer, SpecularEvent event,
                                         const FacetSlope& facet) const {
    const auto& [shape, bsdf, isClearcoat, stopped] = layer;
    if (!hasEvent(bsdf, event.event)) return std::nullopt;
    const bool byFacet = !isDelta(event.event);
    const Vec3d& d = last_.direction;
    const double side = dot(d, shape.ng) < 0.0 ? 1.0 : -1.0;
    const MovingPlace at = meet(last_, shape);
    const MovingNormal shading = event.aboutNg ? MovingNormal{shape.ng, {}} : normalAt(shape, at);
    const MovingNormal normal =
        byFacet ? facetAbout(shading, facet, double(bsdf.narrowAlpha())) : shading;
    const Vec3d n = normal.at * side;
    const double cosine = -dot(d, n);
    if (!(cosine >= double(kMinCosine))) return std::nullopt;

    Step step;
    step.event = event;
    step.facet = facet;
    step.out = {at.at, d, at.by, last_.directionBy};
    const bool straight =
        event.event == ScatterEvent::DeltaTransmission && !bsdf.bends();  // about either normal
    const float aboutNg = bsdf.shareAboutNg(Vec3(-d));
    const bool isSeen = straight || byFacet || (event.aboutNg ? aboutNg > 0.0f : aboutNg < 1.0f);
    if (!isSeen) return std::nullopt;
    const bool transmits = event.event != ScatterEvent::DeltaReflection;
    const bool bends = transmits && bsdf.bends();
    double transmitted = 1.0, q = 2.0 * cosine;  // cosine behind the surface; the change along n
    if (!straight) {
        // d + q n with q a function of the cosine [Igehy99 eq 15, 18].
        double scale = 1.0, qByCosine = 2.0;
        if (bends) {
            scale = 1.0 / double(bsdf.relativeIndex(side > 0.0));
            const double squared = 1.0 - scale * scale * (1.0 - cosine * cosine);
            if (!(squared > 0.0)) return std::nullopt;  // total internal reflection
            transmitted = std::sqrt(squared);
            q = scale * cosine - transmitted;
            qByCosine = scale - scale * scale * cosine / transmitted;
        }
        step.out.direction = d * scale + n * q;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3d nBy = normal.by[i] * side;
            const double cosineBy = -dot(last_.directionBy[i], n) - dot(d, nBy);
            step.out.directionBy[i] =
                last_.directionBy[i] * scale + n * (qByCosine * cosineBy) + nBy * q;
        }
        step.out.direction = normalize(step.out.direction);
        // A sheet lets through what would be reflected, mirrored by the sheet.
        if (transmits && !bends) step.out = mirroredBy(shading, step.out);
    }
    if ((dot(step.out.direction, shape.ng) * side < 0.0) != transmits) return std::nullopt;

    step.toEye = Vec3(-d);
    step.toLight = Vec3(step.out.direction);
    const BsdfEvaluation e = bsdf.evaluate(step.toEye, step.toLight, event.event);
    // A walk's generalised density without its pmf (bsdf.h). `through` is f with its
    // cosine over that.
    step.measure = std::fabs(dot(step.out.direction, n));
    if (byFacet) {
        // d h / d toLight [Walter07 eq 14, 17].
        const double byLight = bends ? transmitted / (q * q) : 0.25 / cosine;
        step.measure = pdfOfFacet(facet, double(bsdf.narrowAlpha())) * byLight;
    } else if (transmits) {
        const double index = double(bsdf.indexOn(dot(step.out.direction, shape.ng) > 0.0));
        step.measure = straight ? std::fabs(dot(d, shape.ng)) : step.measure * index * index;
    }
    step.scatter = e.f;
    if (!isClearcoat) {
        step.scatter *= vertices_[size_].bsdf.underOwnClearcoat(step.toEye, step.toLight);
    }
    step.through =
        step.scatter * stopped * float(std::fabs(dot(step.out.direction, shape.ng)) / step.measure);
    if (isBlack(step.through)) return std::nullopt;
    return step;
}

/// Sets the next vertex without its event. False where the surface has no specular event.
bool Chain::arriveAt(const Scene& scene, const Hit& hit) {
    if (size_ == kMost) return false;
    ChainVertex& v = vertices_[size_];
    scene.surfaceAt(hit, v.point);
    v.bsdf = scene.bsdfAt(v.point);
    return isSpecular(v.bsdf) || v.bsdf.refractsNarrowly();
}

/// Empty where the surface has no such layer, or one that is not specular.
std::optional<Chain::Layer> Chain::layerAt(const Scene& scene, const Hit& hit,
                                           bool clearcoat) const {
    const ChainVertex& v = vertices_[size_];
    const bool two = v.bsdf.hasOwnClearcoat();
    if (clearcoat && !two) return std::nullopt;
    const Bsdf bsdf = !two        ? v.bsdf
                      : clearcoat ? v.bsdf.clearcoatAlone()
                                  : v.bsdf.withoutClearcoat();
    if (!isSpecular(bsdf) && !bsdf.refractsNarrowly()) return std::nullopt;
    return Layer{scene.shapeAt(hit, v.point, clearcoat), bsdf, clearcoat,
                 scene.shareStopped(hit, Vec3(last_.direction))};
}

void Chain::take(const Hit& hit, const Layer& layer, const Step& step) {
    ChainVertex& v = vertices_[size_++];
    v.hit = hit;
    v.corners = layer.shape.corners;
    v.event = step.event;
    v.facet = step.facet;
    v.toEye = step.toEye;
    v.toLight = step.toLight;
    v.through = step.through;
    v.scatter = step.scatter;
    v.measure = step.measure;
    v.point.position = Vec3(step.out.origin);
    last_ = step.out;
}

bool Chain::extend(const Scene& scene, const Hit& hit, SpecularEvent event, FacetSlope facet) {
    if (!isDelta(event.event) && !mayBeNarrowGlass(scene.materialAt(hit))) return false;
    if (!arriveAt(scene, hit)) return false;
    const std::optional<Layer> layer = layerAt(scene, hit, event.onClearcoat);
    if (!layer) return false;
    const std::optional<Step> step = stepAt(*layer, event, facet);
    if (step) take(hit, *layer, *step);
    return step.has_value();
}

bool Chain::extend(const Scene& scene, const Hit& hit, double u) {
    if (!arriveAt(scene, hit)) return false;
    struct Way {
        Layer layer;
        Step step;
    };
    std::array<std::optional<Way>, 8> ways;
    double sum = 0.0;
    std::size_t count = 0;
    for (const bool clearcoat : {false, true}) {
        const std::optional<Layer> layer = layerAt(scene, hit, clearcoat);
        if (!layer) continue;
        const Bsdf& bsdf = layer->bsdf;
        const bool tilted = !(bsdf.ns() == bsdf.ng());
        for (const ScatterEvent event :
             {ScatterEvent::DeltaReflection, ScatterEvent::DeltaTransmission}) {
            const bool twice = tilted && (event == ScatterEvent::DeltaReflection || bsdf.bends());
            for (const bool aboutNg : {false, true}) {
                if (aboutNg && !twice) continue;
                const auto step = stepAt(*layer, {event, aboutNg, clearcoat});
                if (!step) continue;
                sum += double(mean(step->through));
                ways[count++] = Way{*layer, *step};
            }
        }
    }
    double left = u * sum;
    for (std::size_t i = 0; i < count; ++i) {
        left -= double(mean(ways[i]->step.through));
        if (left >= 0.0 && i + 1 < count) continue;
        take(hit, ways[i]->layer, ways[i]->step);
        return true;
    }
    return false;
}

std::optional<Hit> Chain::meetAgain(const ChainVertex& vertex) const {
    if (size_ > 0) {
        const Hit& left = vertices_[size_ - 1].hit;
        const bool same =
            left.object == vertex.hit.object && left.primitive == vertex.hit.primitive;
        if (same) return std::nullopt;  // a ray does not meet the plane that it leaves
    }
    // [Moeller97]
    const auto& [a, b, c] = vertex.corners;
    const Vec3d u = b - a, v = c - a, p = cross(last_.direction, v);
    const double determinant = dot(u, p);
    if (determinant == 0.0) return std::nullopt;
    const Vec3d from = last_.origin - a, q = cross(from, u);
    const double alongU = dot(from, p) / determinant;
    const double alongV = dot(last_.direction, q) / determinant;
    const double distance = dot(v, q) / determinant;
    if (!(alongU >= 0.0 && alongV >= 0.0 && alongU + alongV <= 1.0 && distance > 0.0)) {
        return std::nullopt;
    }
    return Hit{vertex.hit.object, vertex.hit.primitive, float(alongU), float(alongV),
               float(distance)};
}

bool Chain::sameEventsAs(const Chain& other) const {
    if (size_ != other.size_) return false;
    for (std::size_t i = 0; i < size_; ++i) {
        if (!(vertices_[i].event == other.vertices_[i].event)) return false;
    }
    return true;
}

}  // namespace lacuna

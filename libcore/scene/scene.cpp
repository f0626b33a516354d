#include "libcore/scene/scene.h"

#include <algorithm>
#include <bit>

#include "libcore/base/error.h"
#include "libcore/base/extent.h"
#include "libcore/base/number_text.h"
#include "libcore/base/rng.h"
#include "libcore/image/image_io.h"
#include "libcore/scene/emitters.h"

namespace lacuna {

namespace {

/// Absorption coefficients by material; empty if none absorbs.
std::vector<Rgb> absorptions(std::span<const Material> materials) {
    std::vector<Rgb> all;
    bool any = false;
    for (const Material& m : materials) {
        all.push_back(m.absorption);
        any = any || !isBlack(m.absorption);
    }
    return any ? all : std::vector<Rgb>{};
}

/// Throws InputError if `what`, at this distance from the scene's centre, is too far.
void requireNear(const SceneDescription& scene, const std::string& what, double distance) {
    if (distance <= kFarthest) return;
    throw InputError(scene.file + ": " + what + ": expected to be within " + numberText(kFarthest) +
                     " of the scene's middle, found " + numberText(distance) +
                     "; scale the scene down, or take out what is far away");
}

std::unique_ptr<Accel> makeAccel(const BakedScene& baked, const Surfaces& surfaces,
                                 Accel::HoleTest stops, const ThreadPool& pool) {
    std::vector<AccelMesh> meshes;
    for (const BakedMesh& m : baked.meshes) meshes.push_back({m.positions, m.triangles});
    std::vector<AccelObject> objects;
    for (const SceneObject& o : baked.objects) {
        AccelObject a;
        a.mesh = o.mesh;
        a.instanced = o.instanced;
        for (std::size_t c = 0; c < 4; ++c) a.toWorld.m[c] = Vec3d(o.toWorld[c]);
        const Material& material = surfaces.materialOf(o);
        a.hasHoles = material.pane || surfaces.hasHoles(o);
        a.hiddenFromCamera = material.hiddenFromCamera;
        objects.push_back(a);
    }
    return std::make_unique<Accel>(meshes, objects, std::move(stops), pool);
}

}  // namespace

Scene::Scene(SceneDescription description, const ThreadPool& pool)
    : description_(std::move(description)),
      baked_(bake(description_, pool)),
      offsetFloor_(baked_.radius / 32.0f),
      hasFarTextures_(std::any_of(baked_.meshes.begin(), baked_.meshes.end(),
                                  [](const BakedMesh& m) { return !m.farTextures.empty(); })),
      surfaces_(description_, baked_),
      shading_(description_, baked_.meshes),
      absorption_(absorptions(description_.materials)) {
    requireNear(description_, "the outermost vertex", double(baked_.radius));
    for (const PunctualLight& light : description_.lights) {
        if (light.kind == PunctualLight::Kind::Directional) continue;
        requireNear(description_, "a lamp", length(light.position - baked_.centre));
    }
    if (const auto& e = description_.environment) {
        Image map = e->colour ? Image(1, 1, *e->colour) : readImage(e->file);
        environment_ =
            std::make_unique<Environment>(std::move(map), e->scale, e->rotationDegrees,
                                          e->colour ? "the environment's colour" : e->file);
    }
    lights_ = std::make_unique<Lights>(emissiveTriangles(description_, baked_), description_.lights,
                                       baked_.centre, environment_.get(), baked_.radius);
    accel_ = makeAccel(
        baked_, surfaces_,
        [this](const Hit& hit, Vec3 origin, Vec3 direction) {
            return stops(hit, origin, direction);
        },
        pool);
}

Scene::~Scene() = default;

const Material& Scene::materialAt(const Hit& hit) const {
    return surfaces_.materialOf(baked_.objects[hit.object]);
}

float Scene::shareStopped(const Hit& hit, const Vec3& direction) const {
    const Material& material = materialAt(hit);
    if (stopsAllRays(material)) return 1.0f;
    if (!material.pane) return surfaces_.opacity(hit);
    SurfacePoint point;
    surfaceAt(hit, point);
    return 1.0f - bsdfAt(point).passing(direction);
}

bool Scene::stops(const Hit& hit, Vec3 origin, Vec3 direction) const {
    const SceneObject& object = baked_.objects[hit.object];
    const float share = shareStopped(hit, object.instanced ? object.vector(direction) : direction);
    if (share <= 0.0f || share >= 1.0f) return share > 0.0f;
    // The decision is a hash of the ray: it needs no state, and the same ray traced again meets the
    // same surfaces. All strategies for a path have the same probability of passing its edges and
    // meeting its vertices, except for the lamp's point, where light subpaths begin
    // (LightPoint::opacity).
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
    return hashToUniform({bits(origin.x), bits(origin.y), bits(origin.z), bits(direction.x),
                          bits(direction.y), bits(direction.z), hit.object, hit.primitive}) < share;
}

std::vector<NamedLights> Scene::namedLights() const {
    return lacuna::namedLights(description_, baked_, environment_ != nullptr);
}

std::vector<ObjectNames> Scene::objectNames() const {
    return lacuna::objectNames(description_, baked_);
}

Camera Scene::makeCamera(const std::string& name, Camera::Film film, Camera::Lens lens) const {
    const auto& cameras = description_.cameras;
    if (cameras.empty()) {
        throw InputError(description_.file +
                         ": expected a perspective camera, found none: add one to the scene");
    }
    std::string names;
    for (const CameraDescription& c : cameras) {
        if (name.empty() || c.name == name) {
            requireNear(description_, "the camera", length(c.toWorld.m[3] - baked_.centre));
            return Camera(c, baked_.centre, film, lens);
        }
        names += (names.empty() ? "'" : ", '") + c.name + "'";
    }
    throw UsageError("camera: expected one of " + names + ", found '" + name + "'");
}

std::optional<Hit> Scene::trace(const Vec3& origin, const Vec3& ng, const Vec3& direction,
                                RayKind kind, RayTally& tally) const {
    ++tally.counts[std::size_t(kind)];
    Ray ray{offsetOrigin(origin, ng, direction, offsetFloor_), direction};
    ray.atLens = kind == RayKind::Camera;
    const std::optional<Hit> hit = accel_->intersect(ray);
    if (tally.recording) {
        if (hit) ray.tFar = hit->distance;
        tally.recording->push_back({ray, kind});
    }
    return hit;
}

std::optional<SurfacePoint> Scene::intersect(const Vec3& origin, const Vec3& ng,
                                             const Vec3& direction, RayKind kind,
                                             RayTally& tally) const {
    const std::optional<Hit> hit = trace(origin, ng, direction, kind, tally);
    if (!hit) return std::nullopt;
    SurfacePoint point;
    surfaceAt(*hit, point);
    return point;
}

bool Scene::visible(const Vec3& a, const Vec3& ngA, const Vec3& b, const Vec3& ngB, RayKind kind,
                    RayTally& tally) const {
    ++tally.counts[std::size_t(kind)];
    const Vec3 direction = b - a;
    const Vec3 from = offsetOrigin(a, ngA, direction, offsetFloor_);
    const Vec3 to = offsetOrigin(b, ngB, -direction, offsetFloor_);
    const Ray ray{from, to - from, 1.0f - 1e-6f, kind == RayKind::Splat};
    if (tally.recording) tally.recording->push_back({ray, kind});
    return !accel_->occluded(ray);
}

bool Scene::visibleToInfinity(const Vec3& a, const Vec3& ngA, const Vec3& direction, RayKind kind,
                              RayTally& tally) const {
    ++tally.counts[std::size_t(kind)];
    Ray ray{offsetOrigin(a, ngA, direction, offsetFloor_), direction};
    ray.atLens = kind == RayKind::Splat;
    if (tally.recording) tally.recording->push_back({ray, kind});
    return !accel_->occluded(ray);
}

}  // namespace lacuna

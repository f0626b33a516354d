#include "libcore/scene/accel.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"

namespace lacuna {

const char* name(RayKind kind) {
    static constexpr const char* kNames[kRayKinds] = {"camera", "eye",   "light", "connection",
                                                      "splat",  "cache", "chain"};
    return kNames[std::size_t(kind)];
}

namespace {
constexpr unsigned kAtLens = 1;  // id of an Embree ray, for the filter
}

struct Accel::Impl {
    /// Data by which a filter callback finds the object of an Embree geometry.
    struct FilterData {
        const Impl* impl;
        std::uint32_t object;
        bool hasHoles, hiddenFromCamera;
    };

    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<RTCScene> meshScenes;  // by mesh; null if it is not instanced
    std::vector<FilterData> filterData;
    HoleTest holeTest;
    RTCError errorCode = RTC_ERROR_NONE;  ///< the first one
    std::string error;

    ~Impl() {
        for (RTCScene s : meshScenes) {
            if (s) rtcReleaseScene(s);
        }
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }

    /// Throws if Embree reported an error. Embree reports its own lack of memory, but not always
    /// that of the threads that it starts.
    void require(RTCError code, const std::string& text) const {
        if (code == RTC_ERROR_NONE) return;
        if (code == RTC_ERROR_OUT_OF_MEMORY || text.empty()) throw std::bad_alloc();
        throw RunError("ray acceleration structure: expected Embree to build it, found: " + text);
    }

    RTCGeometry makeTriangles(const AccelMesh& mesh) const {
        RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   mesh.positions.data(), 0, sizeof(Vec3),
                                   mesh.positions.size() - 1);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, 3 * sizeof(std::uint32_t),
                                   mesh.triangles.size());
        rtcSetGeometryBuildQuality(g, RTC_BUILD_QUALITY_MEDIUM);
        return g;
    }

    static void filter(const RTCFilterFunctionNArguments* args) {
        const auto& data = *static_cast<const FilterData*>(args->geometryUserPtr);
        for (unsigned i = 0; i < args->N; ++i) {
            if (args->valid[i] != -1) continue;
            if (data.hiddenFromCamera && RTCRayN_id(args->ray, args->N, i) == kAtLens) {
                args->valid[i] = 0;
                continue;
            }
            if (!data.hasHoles) continue;
            const unsigned instance = RTCHitN_instID(args->hit, args->N, i, 0);
            const Hit hit{instance != RTC_INVALID_GEOMETRY_ID ? instance : data.object,
                          RTCHitN_primID(args->hit, args->N, i), RTCHitN_u(args->hit, args->N, i),
                          RTCHitN_v(args->hit, args->N, i)};
            const Vec3 origin{RTCRayN_org_x(args->ray, args->N, i),
                              RTCRayN_org_y(args->ray, args->N, i),
                              RTCRayN_org_z(args->ray, args->N, i)};
            const Vec3 direction{RTCRayN_dir_x(args->ray, args->N, i),
                                 RTCRayN_dir_y(args->ray, args->N, i),
                                 RTCRayN_dir_z(args->ray, args->N, i)};
            if (!data.impl->holeTest(hit, origin, direction)) args->valid[i] = 0;
        }
    }

    /// Attaches the filter only where it is needed: it slows rays down.
    void attachFilter(RTCGeometry g, const AccelObject& object, std::uint32_t index) {
        if (!object.hasHoles && !object.hiddenFromCamera) return;
        filterData.push_back({this, index, object.hasHoles, object.hiddenFromCamera});
        rtcSetGeometryUserData(g, &filterData.back());
        rtcSetGeometryIntersectFilterFunction(g, &Impl::filter);
        rtcSetGeometryOccludedFilterFunction(g, &Impl::filter);
    }

    RTCScene newScene() const {
        RTCScene s = rtcNewScene(device);
        // Without ROBUST, rays slip through edges shared by triangles (numerics.md, "Rays").
        rtcSetSceneFlags(s, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(s, RTC_BUILD_QUALITY_MEDIUM);
        return s;
    }
};

Accel::Accel(std::span<const AccelMesh> meshes, std::span<const AccelObject> objects,
             HoleTest holeTest, const ThreadPool& pool)
    : impl_(std::make_unique<Impl>()) {
    Impl& a = *impl_;
    a.holeTest = std::move(holeTest);
    a.filterData.reserve(objects.size());
    a.device = rtcNewDevice(nullptr);
    if (!a.device) throw std::bad_alloc();  // Embree would say "unknown error"
    rtcSetDeviceErrorFunction(
        a.device,
        [](void* self, RTCError code, const char* text) {
            Impl& impl = *static_cast<Impl*>(self);
            if (impl.errorCode != RTC_ERROR_NONE) return;
            impl.errorCode = code;
            impl.error = text ? text : "";
        },
        &a);

    a.scene = a.newScene();
    a.meshScenes.resize(meshes.size(), nullptr);
    pool.run([&] {
        for (std::uint32_t i = 0; i < objects.size(); ++i) {
            const AccelObject& object = objects[i];
            RTCGeometry g;
            if (object.instanced) {
                RTCScene& shared = a.meshScenes[object.mesh];
                if (!shared) {
                    shared = a.newScene();
                    RTCGeometry triangles = a.makeTriangles(meshes[object.mesh]);
                    a.attachFilter(triangles, object, i);
                    rtcCommitGeometry(triangles);
                    rtcAttachGeometry(shared, triangles);
                    rtcReleaseGeometry(triangles);
                    rtcCommitScene(shared);
                }
                g = rtcNewGeometry(a.device, RTC_GEOMETRY_TYPE_INSTANCE);
                rtcSetGeometryInstancedScene(g, shared);
                float m[12];
                for (int c = 0; c < 4; ++c) {
                    for (int r = 0; r < 3; ++r) m[3 * c + r] = float(object.toWorld.m[c][r]);
                }
                rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, m);
            } else {
                g = a.makeTriangles(meshes[object.mesh]);
                a.attachFilter(g, object, i);
            }
            rtcCommitGeometry(g);
            rtcAttachGeometryByID(a.scene, g, i);
            rtcReleaseGeometry(g);
        }
        rtcCommitScene(a.scene);
    });
    a.require(a.errorCode, a.error);
}

Accel::~Accel() = default;
Accel::Accel(Accel&&) noexcept = default;
Accel& Accel::operator=(Accel&&) noexcept = default;

namespace {
void fill(RTCRay& r, const Ray& ray) {
    r.org_x = ray.origin.x;
    r.org_y = ray.origin.y;
    r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x;
    r.dir_y = ray.direction.y;
    r.dir_z = ray.direction.z;
    r.tnear = 0.0f;
    r.tfar = ray.tFar;
    r.time = 0.0f;
    r.mask = unsigned(-1);
    r.id = ray.atLens ? kAtLens : 0;
    r.flags = 0;
}
}  // namespace

std::optional<Hit> Accel::intersect(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit rh;
    fill(rh.ray, ray);
    rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(impl_->scene, &context, &rh);
    if (rh.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const unsigned instance = rh.hit.instID[0];
    return Hit{instance != RTC_INVALID_GEOMETRY_ID ? instance : rh.hit.geomID, rh.hit.primID,
               rh.hit.u, rh.hit.v, rh.ray.tfar};
}

bool Accel::occluded(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay r;
    fill(r, ray);
    rtcOccluded1(impl_->scene, &context, &r);
    return r.tfar < 0.0f;
}

std::size_t Accel::replay(std::span<const RecordedRay> rays) const {
    std::size_t hits = 0;
    for (const RecordedRay& recorded : rays) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        const bool any = recorded.kind == RayKind::Connection || recorded.kind == RayKind::Splat ||
                         recorded.kind == RayKind::Cache;
        if (any) {
            RTCRay r;
            fill(r, recorded.ray);
            rtcOccluded1(impl_->scene, &context, &r);
            hits += r.tfar < 0.0f;
        } else {
            RTCRayHit rh;
            fill(rh.ray, recorded.ray);
            rh.ray.tfar = std::numeric_limits<float>::infinity();
            rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(impl_->scene, &context, &rh);
            hits += rh.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
    }
    return hits;
}

}  // namespace lacuna

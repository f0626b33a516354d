#include "libcore/voxel/surface_distance.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <string>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

/// Squared distance from the origin to a triangle, by the region of its plane that contains the
/// foot of the perpendicular [Ericson 2005, 5.1.5].
double squaredDistanceToOrigin(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d ab = b - a, ac = c - a;
    const double d1 = -dot(ab, a), d2 = -dot(ac, a);
    if (d1 <= 0.0 && d2 <= 0.0) return lengthSquared(a);
    const double d3 = -dot(ab, b), d4 = -dot(ac, b);
    if (d3 >= 0.0 && d4 <= d3) return lengthSquared(b);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return lengthSquared(a + ab * (d1 / (d1 - d3)));
    const double d5 = -dot(ab, c), d6 = -dot(ac, c);
    if (d6 >= 0.0 && d5 <= d6) return lengthSquared(c);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return lengthSquared(a + ac * (d2 / (d2 - d6)));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        return lengthSquared(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
    }
    const Vec3d n = cross(ab, ac);
    const double h = dot(n, a);
    return h * h / lengthSquared(n);
}

struct Query {
    const Vec3* positions;
    Vec3d point;
    double best;  // squared
};

bool visitTriangle(RTCPointQueryFunctionArguments* args) {
    Query& query = *static_cast<Query*>(args->userPtr);
    const Vec3* t = query.positions + 3 * std::size_t(args->primID);
    const double d2 = squaredDistanceToOrigin(Vec3d(t[0]) - query.point, Vec3d(t[1]) - query.point,
                                              Vec3d(t[2]) - query.point);
    if (d2 >= query.best) return false;
    query.best = d2;
    // The traversal runs in float: the radius is a little larger, so that no nearer triangle is
    // culled.
    args->query->radius = float(std::sqrt(d2) * (1.0 + 1e-6));
    return true;
}

}  // namespace

struct SurfaceDistance::Impl {
    std::vector<Vec3> positions;
    std::vector<std::array<std::uint32_t, 3>> indices;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    double magnitude = 0.0;  // largest coordinate, for the rounding of p to float

    ~Impl() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

SurfaceDistance::SurfaceDistance(std::span<const Triangle> triangles, const ThreadPool& pool)
    : impl_(std::make_unique<Impl>()) {
    Impl& a = *impl_;
    a.positions.reserve(3 * triangles.size() + 1);
    a.indices.reserve(triangles.size());
    for (const Triangle& t : triangles) {
        const auto first = std::uint32_t(a.positions.size());
        a.indices.push_back({first, first + 1, first + 2});
        for (const Vec3& p : t) {
            a.positions.push_back(p);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                a.magnitude = std::max(a.magnitude, std::fabs(double(p[axis])));
            }
        }
    }
    a.positions.push_back({});  // padding: Embree loads 16 bytes at a time
    a.device = rtcNewDevice(nullptr);
    if (!a.device) throw RunError("distances: Embree failed: no device; is there memory left?");
    a.scene = rtcNewScene(a.device);
    pool.run([&] {
        RTCGeometry g = rtcNewGeometry(a.device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   a.positions.data(), 0, sizeof(Vec3), a.positions.size() - 1);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, a.indices.data(),
                                   0, 3 * sizeof(std::uint32_t), a.indices.size());
        rtcSetGeometryPointQueryFunction(g, &visitTriangle);
        rtcCommitGeometry(g);
        rtcAttachGeometry(a.scene, g);
        rtcReleaseGeometry(g);
        rtcCommitScene(a.scene);
    });
    if (rtcGetDeviceError(a.device) != RTC_ERROR_NONE) {
        throw RunError("distances: Embree failed to build; use fewer triangles or more memory");
    }
}

SurfaceDistance::~SurfaceDistance() = default;

double SurfaceDistance::operator()(const Vec3d& p, double bound) const {
    Query query{impl_->positions.data(), p, bound * bound};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery q{};
    q.x = float(p.x);
    q.y = float(p.y);
    q.z = float(p.z);
    q.radius = float(bound * (1.0 + 1e-6) + 1e-6 * impl_->magnitude);
    rtcPointQuery(impl_->scene, &q, &context, nullptr, &query);
    return std::sqrt(query.best);
}

std::vector<float> surfaceDistances(const SurfaceDistance& surface, const VoxelShape& shape,
                                    std::span<const VoxelState> state, const ThreadPool& pool,
                                    const std::atomic<bool>& cancel) {
    std::vector<float> distance(shape.count(), 0.0f);
    const auto row = std::size_t(shape.size[0]);
    pool.forEach(std::size_t(shape.size[1]) * std::size_t(shape.size[2]), [&](std::size_t r) {
        if (cancel) return;
        // From voxel to voxel the distance changes by at most one voxel, which gives a tight bound
        // along the row.
        double bound = std::numeric_limits<double>::infinity();
        for (std::size_t i = r * row; i < (r + 1) * row; ++i) {
            if (state[i] != VoxelState::Empty) {
                bound = std::numeric_limits<double>::infinity();
                continue;
            }
            const double d = surface(shape.centre(shape.indexOf(i)), bound);
            distance[i] = float(d);
            bound = (d + shape.voxel) * (1.0 + 1e-12);
        }
    });
    throwIfCancelled(cancel);
    return distance;
}

}  // namespace lacuna

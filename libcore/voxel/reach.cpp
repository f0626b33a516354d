#include "libcore/voxel/reach.h"

#include <algorithm>
#include <limits>

#include "libcore/base/parallel.h"
#include "libcore/bidir/walk.h"
#include "libcore/voxel/components.h"

namespace lacuna {

namespace {

constexpr std::size_t kPathsPerTask = 256, kTasks = 48;
constexpr int kFilmSide = 128;
constexpr int kProbes = 8;          // pieces of a segment; voxels are looked up between them
constexpr double kTrimmed = 0.002;  // share of the vertices, at each end of each axis
constexpr double kMargin = 0.05;    // share of the box's side, at each end

void addSegments(const std::vector<PathVertex>& path, std::vector<Reach::Segment>& out) {
    for (std::size_t i = 1; i < path.size(); ++i) {
        if (path[i - 1].infinite() || path[i].infinite()) continue;
        out.push_back({path[i - 1].position, path[i].position});
    }
}

/// Runs the tasks in parallel and returns their segments in the order of tasks.
template <class Trace>
std::vector<Reach::Segment> trace(const ThreadPool& pool, const Trace& trace) {
    std::vector<std::vector<Reach::Segment>> parts(kTasks);
    pool.forEach(kTasks, [&](std::size_t task) {
        std::vector<PathVertex> path;
        RayTally tally;
        for (std::size_t i = task * kPathsPerTask; i < (task + 1) * kPathsPerTask; ++i) {
            Rng rng(1, 0, StreamKind::User, i);
            trace(i, rng, tally, path);
            addSegments(path, parts[task]);
        }
    });
    std::vector<Reach::Segment> all;
    for (const auto& p : parts) all.insert(all.end(), p.begin(), p.end());
    return all;
}

}  // namespace

Reach traceReach(const Scene& scene, const ThreadPool& pool) {
    Reach reach;
    const auto& cameras = scene.description().cameras;
    if (cameras.empty()) return reach;
    for (const CameraDescription& description : cameras) {
        const double aspect = description.aspectRatio > 0.0 ? description.aspectRatio : 16.0 / 9.0;
        const Camera camera(description, scene.centre(),
                            {int(std::clamp(kFilmSide * aspect, 1.0, 1024.0)), kFilmSide}, {});
        const Walker walker(scene, camera, {});
        const auto fromCamera =
            trace(pool, [&](std::size_t, Rng& rng, RayTally& tally, std::vector<PathVertex>& path) {
                const Vec2 raster{rng.uniform() * float(camera.film().width),
                                  rng.uniform() * float(camera.film().height)};
                walker.traceEye(raster, rng, tally, path);
            });
        reach.camera.insert(reach.camera.end(), fromCamera.begin(), fromCamera.end());
        if (&description != &cameras.front()) continue;
        reach.lamps =
            trace(pool, [&](std::size_t, Rng& rng, RayTally& tally, std::vector<PathVertex>& path) {
                walker.traceLight(rng, tally, path);
                if (!path.empty() && path.front().infinite()) path.clear();
            });
    }
    return reach;
}

VoxelBox boundsOf(std::span<const Triangle> triangles) {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    VoxelBox box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
    for (const Triangle& t : triangles) {
        for (const Vec3& p : t) {
            box.low = min(box.low, Vec3d(p));
            box.high = max(box.high, Vec3d(p));
        }
    }
    return box;
}

VoxelBox defaultDomain(const Reach& reach, const VoxelBox& scene) {
    if (reach.camera.empty()) return scene;
    VoxelBox box;
    std::vector<float> places(reach.camera.size());
    for (std::size_t a = 0; a < 3; ++a) {
        std::transform(reach.camera.begin(), reach.camera.end(), places.begin(),
                       [a](const Reach::Segment& s) { return s[1][a]; });
        std::sort(places.begin(), places.end());
        const auto cut = std::size_t(kTrimmed * double(places.size()));
        const double low = double(places[cut]), high = double(places[places.size() - 1 - cut]);
        const double margin = kMargin * (high - low);
        box.low[a] = std::max(scene.low[a], low - margin);
        box.high[a] = std::min(scene.high[a], high + margin);
    }
    return box;
}

PartCounts keepReachedParts(const Reach& reach, const VoxelShape& shape,
                            std::span<VoxelState> state) {
    const Components parts(shape, state, {}, Connectivity::Corners);
    std::vector<bool> reached(parts.count(), reach.camera.empty() && reach.lamps.empty());
    for (const auto* segments : {&reach.camera, &reach.lamps}) {
        for (const Reach::Segment& s : *segments) {
            const Vec3d from(s[0]), to(s[1]);
            for (int i = 1; i < kProbes; ++i) {
                const VoxelIndex v = shape.voxelOf(from + (to - from) * (double(i) / kProbes));
                if (!shape.contains(v)) continue;
                if (const auto part = parts.at(v); part >= 0) reached[std::size_t(part)] = true;
            }
        }
    }
    PartCounts result{parts.count(), 0};
    for (const bool r : reached) result.reached += r ? 1 : 0;
    for (std::size_t i = 0; i < state.size(); ++i) {
        if (state[i] == VoxelState::Solid) continue;
        const auto part = std::size_t(parts.at(shape.indexOf(i)));
        state[i] = reached[part] ? VoxelState::Empty : VoxelState::Unreached;
    }
    return result;
}

}  // namespace lacuna

#include "preprocess/voxelize.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/voxel/surface_distance.h"

namespace lacuna {

namespace {
/// Names of options in messages: those of the preprocessing tools and of lacuna-render --prepare.
constexpr const char* kDomain = "--domain (lacuna-render: --set voxels.domain)";
constexpr const char* kResolution = "--resolution (lacuna-render: --set voxels.resolution)";
}  // namespace

VoxelBox parseDomain(const std::string& text) {
    double number[6];
    const char* at = text.data();
    const char* const end = at + text.size();
    bool good = true;
    for (int i = 0; i < 6 && good; ++i) {
        const auto [next, error] = std::from_chars(at, end, number[i]);
        good = error == std::errc{} && std::isfinite(number[i]) &&
               (i == 5 ? next == end : next != end && *next == ',');
        at = next + (i < 5 ? 1 : 0);
    }
    for (int i = 0; i < 3 && good; ++i) good = number[i] < number[i + 3];
    if (!good) {
        throw UsageError(std::string(kDomain) +
                         ": expected x0,y0,z0,x1,y1,z1 in the scene's coordinates with x0 < x1, "
                         "y0 < y1 and z0 < z1, found '" +
                         text + "'");
    }
    return {{number[0], number[1], number[2]}, {number[3], number[4], number[5]}};
}

CacheStamp voxelStamp(const Settings& sceneInputs, const VoxelSettings& settings) {
    CacheStamp stamp{sceneInputs};
    stamp.inputs["resolution"] = std::to_string(settings.resolution);
    stamp.inputs["domain"] = settings.domain.empty() ? "auto" : settings.domain;
    return stamp;
}

Voxelized voxelizeScene(const Scene& scene, const VoxelSettings& settings, const CacheStamp& stamp,
                        const ThreadPool& pool, const std::atomic<bool>& cancel, Phases& phases) {
    std::vector<Triangle> triangles;
    Reach reach;
    phases.run("reach", [&] {
        triangles = scene.blockingTriangles(pool);
        if (triangles.empty()) {
            throw InputError(scene.description().file +
                             ": expected triangles that stop light, found none: there is no empty "
                             "space to describe");
        }
        reach = traceReach(scene, pool);
    });

    Voxelized result;
    result.file.stamp = stamp;
    VoxelSpace& space = result.file.space;
    bool flat = false;  // too flat: no resolution leaves room between the surfaces
    phases.run("voxelize", [&] {
        if (settings.domain.empty()) {
            const VoxelBox domain = defaultDomain(reach, boundsOf(triangles));
            space.shape = latticeOver(domain, settings.resolution);
            // The surfaces take one layer on each side.
            const VoxelIndex finest = latticeOver(domain, VoxelSettings::kHighestResolution).size;
            flat = std::min({finest[0], finest[1], finest[2]}) < 3;
        } else {
            VoxelBox domain = parseDomain(settings.domain);
            domain.low -= scene.centre();
            domain.high -= scene.centre();
            space.shape = latticeExactlyOver(domain, settings.resolution);
        }
        if (!(space.shape.voxel > 0.0)) {
            throw InputError(scene.description().file +
                             ": expected a scene with an extent, found a point");
        }
        space.state.assign(space.shape.count(), VoxelState::Empty);
        voxelize(triangles, space.shape, space.state, pool, cancel);
    });
    phases.run("parts", [&] { result.parts = keepReachedParts(reach, space.shape, space.state); });
    if (result.parts.reached == 0) {
        if (!settings.domain.empty()) {
            throw UsageError(std::string(kDomain) +
                             ": expected a box that camera paths or lamps reach, found none of "
                             "them in it; leave it out, or raise " +
                             kResolution);
        }
        if (flat) {
            throw UsageError(std::string(kDomain) +
                             ": expected the box of the space in front of the surfaces, because "
                             "this scene's own is flat; found none; give one");
        }
        throw UsageError(std::string(kResolution) +
                         ": expected voxels fine enough to leave empty ones where the camera "
                         "looks, found none; raise it");
    }
    phases.run("distance", [&] {
        const SurfaceDistance surface(triangles, pool);
        space.distance = surfaceDistances(surface, space.shape, space.state, pool, cancel);
    });
    return result;
}

}  // namespace lacuna

#include "libcore/voxel/voxelize.h"

#include <algorithm>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/voxel/exact_overlap.h"

namespace lacuna {

void throwIfCancelled(const std::atomic<bool>& cancel) {
    if (cancel)
        throw InterruptedError(
            "interrupted: expected to finish, found a signal; nothing was written");
}

VoxelShape latticeOver(const VoxelBox& domain, int resolution) {
    const Vec3d extent = domain.high - domain.low;
    const double longest = std::max({extent.x, extent.y, extent.z});
    VoxelShape shape;
    shape.voxel = longest / std::max(1, resolution - 1);
    shape.origin = domain.low - Vec3d{0.5, 0.5, 0.5} * shape.voxel;
    for (std::size_t a = 0; a < 3; ++a) {
        shape.size[a] = std::min(resolution, int(std::floor(extent[a] / shape.voxel + 0.5)) + 1);
    }
    return shape;
}

VoxelShape latticeExactlyOver(const VoxelBox& domain, int resolution) {
    const Vec3d extent = domain.high - domain.low;
    VoxelShape shape;
    shape.voxel = std::max({extent.x, extent.y, extent.z}) / resolution;
    shape.origin = domain.low;
    for (std::size_t a = 0; a < 3; ++a) {
        shape.size[a] = std::clamp(int(std::ceil(extent[a] / shape.voxel - 1e-9)), 1, resolution);
    }
    return shape;
}

namespace {

/// Halves the range of voxels along its longest side until one is left. The number of tests for a
/// wall across the whole grid is thus proportional to its own voxels, not to those of its bounding
/// box.
class Rasterizer {
  public:
    Rasterizer(const TriangleD& triangle, const VoxelShape& shape, std::span<VoxelState> state)
        : triangle_(triangle), shape_(shape), state_(state) {}

    void run(VoxelIndex low, VoxelIndex high) const {
        if (!overlaps(triangle_, shape_.corner(low), shape_.corner(high))) return;
        std::size_t longest = 0;
        for (std::size_t a = 1; a < 3; ++a) {
            if (high[a] - low[a] > high[longest] - low[longest]) longest = a;
        }
        if (high[longest] - low[longest] == 1) {
            // Several triangles may set the same voxel; all write the same value.
            std::atomic_ref(state_[shape_.at(low)])
                .store(VoxelState::Solid, std::memory_order_relaxed);
            return;
        }
        const int middle = (low[longest] + high[longest]) / 2;
        VoxelIndex upper = low, lower = high;
        upper[longest] = lower[longest] = middle;
        run(low, lower);
        run(upper, high);
    }

  private:
    const TriangleD& triangle_;
    const VoxelShape& shape_;
    std::span<VoxelState> state_;
};

}  // namespace

void voxelize(std::span<const Triangle> triangles, const VoxelShape& shape,
              std::span<VoxelState> state, const ThreadPool& pool,
              const std::atomic<bool>& cancel) {
    constexpr std::size_t kPerTask = 256;
    pool.forEach((triangles.size() + kPerTask - 1) / kPerTask, [&](std::size_t task) {
        const std::size_t end = std::min(triangles.size(), (task + 1) * kPerTask);
        for (std::size_t i = task * kPerTask; i < end && !cancel; ++i) {
            const TriangleD t{Vec3d(triangles[i][0]), Vec3d(triangles[i][1]),
                              Vec3d(triangles[i][2])};
            VoxelIndex low = shape.voxelOf(min(t[0], min(t[1], t[2])));
            VoxelIndex high = shape.voxelOf(max(t[0], max(t[1], t[2])));
            bool outside = false;
            for (std::size_t a = 0; a < 3; ++a) {
                // One more on each side: a corner on a lattice plane touches the voxels on both
                // sides.
                low[a] = std::max(low[a] - 1, 0);
                high[a] = std::min(high[a] + 2, shape.size[a]);
                outside |= low[a] >= high[a];
            }
            if (!outside) Rasterizer(t, shape, state).run(low, high);
        }
    });
    throwIfCancelled(cancel);
}

}  // namespace lacuna

// A grid of cubic voxels, and the state of each.
//
// Everything is in the recentred scene's coordinates (Scene::centre()); only files use the
// coordinates of the scene's file. Arrays are dense, and x runs fastest: thinning, distances and
// the node map visit nearly every voxel, and a dense byte is smaller than a voxel's share of a
// sparse tree's topology.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

using VoxelIndex = std::array<int, 3>;

struct VoxelBox {
    Vec3d low, high;
};

/// The lattice: voxel (i, j, k) is the closed cube from corner(i, j, k) to corner(i + 1, j + 1, k +
/// 1).
struct VoxelShape {
    VoxelIndex size{0, 0, 0};
    Vec3d origin;        ///< low corner of voxel (0, 0, 0)
    double voxel = 1.0;  ///< edge length, scene units

    std::size_t count() const {
        return std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]);
    }
    bool contains(const VoxelIndex& v) const {
        return v[0] >= 0 && v[1] >= 0 && v[2] >= 0 && v[0] < size[0] && v[1] < size[1] &&
               v[2] < size[2];
    }
    std::size_t at(const VoxelIndex& v) const {
        return (std::size_t(v[2]) * std::size_t(size[1]) + std::size_t(v[1])) *
                   std::size_t(size[0]) +
               std::size_t(v[0]);
    }
    VoxelIndex indexOf(std::size_t i) const {
        const auto x = i % std::size_t(size[0]), rest = i / std::size_t(size[0]);
        return {int(x), int(rest % std::size_t(size[1])), int(rest / std::size_t(size[1]))};
    }
    Vec3d corner(const VoxelIndex& v) const {
        return {origin.x + v[0] * voxel, origin.y + v[1] * voxel, origin.z + v[2] * voxel};
    }
    Vec3d centre(const VoxelIndex& v) const {
        return {origin.x + (v[0] + 0.5) * voxel, origin.y + (v[1] + 0.5) * voxel,
                origin.z + (v[2] + 0.5) * voxel};
    }
    /// The voxel that contains p, computed with floor: truncation would merge the voxels on both
    /// sides of zero.
    VoxelIndex voxelOf(const Vec3d& p) const {
        const auto cell = [&](double x, double low) {
            // Clamped, so that distant points do not overflow; they stay outside.
            return int(std::clamp(std::floor((x - low) / voxel), -1e9, 1e9));
        };
        return {cell(p.x, origin.x), cell(p.y, origin.y), cell(p.z, origin.z)};
    }
    VoxelBox box() const { return {origin, corner(size)}; }
};

enum class VoxelState : std::uint8_t {
    Unreached,  ///< empty, in a part that neither a camera nor a lamp reaches
    Empty,      ///< empty, in a part that matters
    Solid,      ///< a triangle touches it
};

/// The voxelized scene: what lacuna-voxelize writes.
struct VoxelSpace {
    VoxelShape shape;
    std::vector<VoxelState> state;  ///< one per voxel
    /// Distance from the voxel's centre to the nearest surface, in scene units, exact but for
    /// rounding to float; 0 where the state is not Empty.
    std::vector<float> distance;

    bool empty(const VoxelIndex& v) const {
        return shape.contains(v) && state[shape.at(v)] == VoxelState::Empty;
    }
    /// XXH3-128 of shape, states and distances, in hexadecimal digits. It does not depend on the
    /// number of threads.
    std::string contentHash() const;
};

}  // namespace lacuna

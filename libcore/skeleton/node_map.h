// Which skeleton node a point belongs to.
#pragma once

#include <span>
#include <string>

#include "libcore/skeleton/graph.h"

namespace lacuna {

/// By voxel a node's index; voxels that were extended into the solid say so.
class NodeMap {
  public:
    static constexpr std::uint16_t kSolid = 0x8000;  ///< flag of an entry
    static constexpr std::uint16_t kNone = 0x7fff;   ///< no node

    NodeMap() = default;
    NodeMap(const VoxelShape& shape, std::vector<std::uint16_t> entries)
        : shape_(shape), entries_(std::move(entries)) {}

    const VoxelShape& shape() const { return shape_; }
    std::span<const std::uint16_t> entries() const { return entries_; }

    /// Node of a point on a surface, seen from the side that the unit normal `side` points to:
    /// surfaces lie in solid voxels, and a wall one voxel thick has a node on either side. The
    /// first empty voxel on the way out, by up to two voxels, else the entry that was extended into
    /// the point's own. kNone where there is none, and outside of the grid.
    std::uint16_t at(const Vec3d& point, const Vec3d& side) const;

  private:
    std::uint16_t entry(const Vec3d& point) const;

    VoxelShape shape_;
    std::vector<std::uint16_t> entries_;
};

/// The nearest node by geodesic distance through Empty voxels [Noel15 3], in moves to the 26
/// neighbours of length 1, sqrt 2, sqrt 3 (as multiples of 2^-18, so that sums are exact and ties
/// real ones), from the voxels around each node's lattice corner, ties to the lower index. Solid
/// voxels take over the nearest node of their Empty neighbours likewise. Throws RunError for more
/// nodes than an entry can tell apart, Error 130 once `cancel` is set.
NodeMap mapNodes(const VoxelSpace& space, std::span<const SkeletonNode> nodes,
                 const ThreadPool& pool, const std::atomic<bool>& cancel);

/// What the renderer needs of a skeleton: where the nodes are, and which points belong to them.
struct Skeleton {
    std::vector<SkeletonNode> nodes;
    std::vector<FilteredEdge> edges;
    NodeMap map;

    /// Hex XXH3-128 of all of it.
    std::string contentHash() const;
};

}  // namespace lacuna

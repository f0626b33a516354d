// Map from points to skeleton nodes.
// (theory.md, "Nodes")
#pragma once

#include <initializer_list>
#include <span>
#include <string>

#include "libcore/skeleton/graph.h"

namespace lacuna {

/// A node's index for each voxel. Entries of solid voxels, to which the map was extended, carry a
/// flag.
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
    /// first of these that is an Empty voxel with a node:
    ///   1. the point's own, and those half a voxel and one voxel along `side`;
    ///   2. of the 18 around it that are not behind it along the steepest axis of `side`, among
    ///      those whose centre is in front of the surface, the one whose centre a ball that touches
    ///      the surface at the point meets first as it grows;
    ///   3. 1.5 to 3 voxels along `side`: beyond a place too crowded for an Empty voxel;
    /// else the entry that was extended into the point's own voxel. kNone where there is none, and
    /// outside of the grid. If the 27 voxels around the point hold one flat wall and nothing else,
    /// 1 and 2 find a node, and never one on the other side. Two walls in the point's own voxel are
    /// not told apart. That would need the triangles; an experiment (with rays to the voxels
    /// around) gave no better pictures.
    std::uint16_t at(const Vec3d& point, const Vec3d& side) const;

  private:
    // Places are points relative to the grid's low corner, in voxels.
    std::uint16_t entry(const Vec3d& place) const;
    std::uint16_t firstAlong(const Vec3d& place, const Vec3d& side,
                             std::initializer_list<double> steps) const;
    std::uint16_t around(const Vec3d& place, const Vec3d& side) const;

    VoxelShape shape_;
    std::vector<std::uint16_t> entries_;
};

/// The nearest node of each voxel by geodesic distance through Empty voxels [Noel15 3]. The
/// distance is a sum of moves to the 26 neighbours, of length 1, sqrt 2 or sqrt 3. (They are
/// multiples of 2^-18, so that sums are exact and ties are true ties.) It starts from the voxels
/// around each node's lattice corner; ties go to the lower index. Solid voxels take the nearest
/// node of their Empty neighbours by the same distance. Throws RunError for more nodes than an
/// entry can tell apart, InterruptedError once `cancel` is set.
NodeMap mapNodes(const VoxelSpace& space, std::span<const SkeletonNode> nodes,
                 const ThreadPool& pool, const std::atomic<bool>& cancel);

/// The skeleton as the renderer needs it: the nodes, and the map from points to them.
struct Skeleton {
    std::vector<SkeletonNode> nodes;
    std::vector<FilteredEdge> edges;
    NodeMap map;

    /// XXH3-128 of all of it, in hexadecimal digits.
    std::string contentHash() const;
};

}  // namespace lacuna

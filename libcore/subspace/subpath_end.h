// The end of a subpath, which subpaths are classified by: its last vertex's position, normal and
// incident direction [Su22 6.4]. f_yz depends on these three. (theory.md, "Subspaces", "Beliefs")
//
// It is a function of positions and normals of the path alone, computed in one way for both walks.
// So a vertex has the same subspace whichever strategy made the path. A direction that a walk drew
// and the one that two positions give differ in the last bits, and a tree compares the last bit.
#pragma once

#include <array>

#include "libcore/bidir/path.h"

namespace lacuna {

/// Position, normal on the side that the subpath is on, unit direction to the predecessor: three
/// numbers each, which decision trees address by their index.
struct SubpathEnd {
    static constexpr std::size_t kAttributes = 9;
    std::array<float, kAttributes> value{};

    Vec3 position() const { return {value[0], value[1], value[2]}; }
    Vec3 normal() const { return {value[3], value[4], value[5]}; }
    Vec3 direction() const { return {value[6], value[7], value[8]}; }
};

/// `predecessor`: its position, or at infinity the direction towards it.
inline SubpathEnd subpathEnd(Vec3 position, Vec3 normal, Vec3 predecessor, bool infinite) {
    Vec3 d = predecessor;
    if (!infinite) d = Vec3(normalize(Vec3d(predecessor) - Vec3d(position)));
    const Vec3 n = dot(normal, d) < 0.0f ? -normal : normal;
    return {{position.x, position.y, position.z, n.x, n.y, n.z, d.x, d.y, d.z}};
}

inline SubpathEnd subpathEnd(const PathVertex& vertex, const PathVertex& predecessor) {
    return subpathEnd(vertex.position, vertex.ng, predecessor.position, predecessor.infinite());
}

}  // namespace lacuna

// Converts meshes to the triangles of the voxelization.
#pragma once

#include <vector>

#include "libcore/scene/description.h"
#include "libcore/voxel/exact_overlap.h"

namespace lacuna::test {

/// All triangles of `mesh`, transformed.
inline std::vector<Triangle> trianglesOf(const Mesh& mesh, const Affine& transform = {}) {
    std::vector<Triangle> all;
    for (const auto& t : mesh.triangles) {
        Triangle triangle;
        for (std::size_t c = 0; c < 3; ++c) {
            triangle[c] = Vec3(transform.point(Vec3d(mesh.positions[t[c]])));
        }
        all.push_back(triangle);
    }
    return all;
}

}  // namespace lacuna::test

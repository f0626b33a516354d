// Points and normals of a mesh in world space, in double and directly from the definitions.
#pragma once

#include <string>
#include <vector>

#include "tests/scene/scene_builder.h"

namespace lacuna::test {

struct NamedTransform {
    std::string name;
    Affine toWorld;
};

/// Translation, rotation, scale; negative scale; shear; nested nodes.
inline std::vector<NamedTransform> transforms() {
    const Affine turn = rotation({1, 2, -0.5}, 63), move = translation({0.7, -1.2, 0.4});
    const Affine shear{{Vec3d{1, 0, 0}, Vec3d{0.7, 1, 0}, Vec3d{-0.3, 0.4, 1}, Vec3d{}}};
    return {{"identity", {}},
            {"translated, rotated, scaled", move * turn * scaling({2, 0.5, 1.5})},
            {"mirrored in x", scaling({-1, 1, 1})},
            {"mirrored three times", move * turn * scaling({-1, -2, -0.5})},
            {"sheared", move * shear},
            {"mirrored and sheared", shear * turn * scaling({1, -1, 1}) * move},
            {"nested", move * turn * scaling({3, 1, 1}) * turn * scaling({1, 0.4, -1}) * move},
            {"nearly flat", turn * scaling({1, 1, 1e-3})},
            {"tiny", scaling({1e-4, 1e-4, 1e-4}) * turn}};
}

struct ExactSurface {
    Vec3d position, ng, ns;
    Vec2 uv;
};

/// The surface at barycentric (u, v) of one triangle. Normals are interpolated, then transformed.
inline ExactSurface exactSurface(const Mesh& mesh, std::size_t index, const Affine& m, double u,
                                 double v) {
    const auto& t = mesh.triangles[index];
    const double w = 1 - u - v, sign = m.determinant() < 0 ? -1 : 1;
    const auto corner = [&](int i) { return Vec3d(mesh.positions[t[i]]); };
    ExactSurface s;
    s.position = m.point(corner(0) * w + corner(1) * u + corner(2) * v);
    // The front is the image of the mesh's front, whatever the winding becomes.
    s.ng = normalize(m.normal(cross(corner(1) - corner(0), corner(2) - corner(0))) * sign);
    s.ns = s.ng;
    if (!mesh.normals.empty()) {
        const auto normal = [&](int i) { return normalize(Vec3d(mesh.normals[t[i]])); };
        const Vec3d n = normalize(m.normal(normal(0) * w + normal(1) * u + normal(2) * v) * sign);
        if (std::abs(dot(n, s.ng)) > 1e-3) s.ns = dot(n, s.ng) < 0 ? -n : n;
    }
    if (!mesh.uvs.empty()) {
        s.uv = mesh.uvs[t[0]] * float(w) + mesh.uvs[t[1]] * float(u) + mesh.uvs[t[2]] * float(v);
    }
    return s;
}

/// How a mesh is placed in a scene: transformed to world space at load, or as an Embree instance.
enum class Placement { Baked, Instanced };

/// Adds `mesh` under `toWorld`. For Instanced, adds a second instance too far below to be hit
/// first.
inline void place(SceneBuilder& b, const Mesh& mesh, const Affine& toWorld, Placement placement) {
    const std::uint32_t index = b.add(mesh, toWorld);
    const Affine other = translation({0, -20, 0}) * toWorld;
    if (placement == Placement::Instanced) {
        b.instance(index, other);
    } else {
        b.add(mesh, other);
    }
}

}  // namespace lacuna::test

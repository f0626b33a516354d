#include "libcore/scene/surfaces.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/parallel.h"
#include "libcore/base/sampling.h"
#include "libcore/scene/texture.h"
#include "libcore/scene/triangle.h"

namespace lacuna {

/// Axes of a normal map at a point: the directions, of any length, towards the image's right and
/// upper edge.
struct Surfaces::MapAxes {
    Vec3 right, up;

    /// The directions in which the triangle's texture coordinates grow. glTF's bitangent points to
    /// the image's upper edge, against v [glTF 2.0, 3.9.3].
    static MapAxes byCoordinates(const std::array<Vec3, 3>& corners,
                                 const std::array<Vec2, 3>& uvs) {
        const Vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
        const Vec2 d1 = uvs[1] - uvs[0], d2 = uvs[2] - uvs[0];
        // Only the sign of the determinant matters: lengths are normalised later.
        const float side = d1.x * d2.y - d2.x * d1.y < 0.0f ? -1.0f : 1.0f;
        return {(e1 * d2.y - e2 * d1.y) * side, (e1 * d2.x - e2 * d1.x) * side};
    }
};

namespace {

Vec2 between(const std::vector<Vec2>& uvs, const std::array<std::uint32_t, 3>& t, float u,
             float v) {
    if (uvs.empty()) return {};
    return uvs[t[0]] * (1.0f - u - v) + uvs[t[1]] * u + uvs[t[2]] * v;
}

/// Whether there is a map for which the mesh has coordinates.
bool hasMap(const BakedMesh& mesh, const TextureUse& map) {
    return map && !mesh.uvsOf(map).empty();
}

}  // namespace

float Surfaces::opacity(const Hit& hit) const {
    const BakedMesh& mesh = baked_.meshes[baked_.objects[hit.object].mesh];
    return alphaOf(description_, mesh, hit.primitive).opacity({hit.u, hit.v});
}

bool Surfaces::hasHoles(const SceneObject& object) const {
    return mayHaveHoles(materialOf(object), description_.textures,
                        baked_.meshes[object.mesh].hasVertexAlpha());
}

void Surfaces::pointAt(const Hit& hit, SurfacePoint& s) const {
    const SceneObject& object = baked_.objects[hit.object];
    const BakedMesh& mesh = baked_.meshes[object.mesh];
    const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.primitive];
    const float w = 1.0f - hit.u - hit.v;
    const std::array<Vec3, 3> p = baked_.corners(object, hit.primitive);
    s.position = p[0] * w + p[1] * hit.u + p[2] * hit.v;
    s.ng = object.instanced ? triangleNormal(p[0], p[1], p[2]) : mesh.faceNormals[hit.primitive];
    s.barycentric = {hit.u, hit.v};
    if (object.turned()) {
        s.ng = -s.ng;
        s.barycentric = {hit.v, hit.u};
    }
    s.ns = s.ng;
    bool turned = false;
    if (!mesh.normals.empty()) {
        Vec3 n = mesh.normals[t[0]] * w + mesh.normals[t[1]] * hit.u + mesh.normals[t[2]] * hit.v;
        if (object.instanced) n = object.normalTo(n);
        n = normalize(n);
        const float side = dot(n, s.ng);
        // Normals opposite to the winding are flipped; those at a right angle to ng are ignored.
        turned = side < 0.0f;
        if (std::fabs(side) > 1e-3f) s.ns = turned ? -n : n;
    }
    s.uv = between(mesh.uvs, t, hit.u, hit.v);
    s.object = hit.object;
    s.material = mesh.material;
    s.light = object.firstLight != kNone ? object.firstLight + hit.primitive : kNone;
    s.uv1 = {};
    s.color = Rgb(1.0f);
    s.clearcoatNs = s.grain = {};
    if (!mesh.plain) decorate(hit, p, turned, s);
    for (const TextureUse& use : mesh.farTextures) {
        prefetchTexture(description_.textures[std::size_t(use.value)],
                        use.at(use.secondSet ? s.uv1 : s.uv));
    }
}

SurfaceShape Surfaces::shapeAt(const Hit& hit, const SurfacePoint& point, bool clearcoat) const {
    const SceneObject& object = baked_.objects[hit.object];
    const BakedMesh& mesh = baked_.meshes[object.mesh];
    SurfaceShape shape;
    const std::array<Vec3, 3> corners = baked_.corners(object, hit.primitive);
    for (std::size_t i = 0; i < 3; ++i) shape.corners[i] = Vec3d(corners[i]);
    const auto& [a, b, c] = shape.corners;
    shape.ng = normalize(cross(b - a, c - a));
    if (dot(shape.ng, Vec3d(point.ng)) < 0.0) shape.ng = -shape.ng;
    shape.normals.fill(shape.ng);
    Vec3 SurfacePoint::*const normal = clearcoat ? &SurfacePoint::clearcoatNs : &SurfacePoint::ns;
    if (point.*normal == point.ng) return shape;  // flat, or its normals are ignored
    const double u(hit.u), v(hit.v);
    const Material& material = description_.materials[mesh.material];
    if (hasMap(mesh, clearcoat ? material.clearcoatNormalTexture : material.normalTexture)) {
        constexpr float kStep = 0x1p-10f;  // of the triangle: enough in texels for float precision
        const auto normalAt = [&](float du, float dv) {
            Hit near = hit;
            near.u += du;
            near.v += dv;
            SurfacePoint other;
            pointAt(near, other);
            return Vec3d(other.*normal);
        };
        constexpr double kInverse = 0.5 / double(kStep);
        const Vec3d byU = (normalAt(kStep, 0) - normalAt(-kStep, 0)) * kInverse;
        const Vec3d byV = (normalAt(0, kStep) - normalAt(0, -kStep)) * kInverse;
        shape.normals[0] = Vec3d(point.*normal) - byU * u - byV * v;
        shape.normals[1] = shape.normals[0] + byU;
        shape.normals[2] = shape.normals[0] + byV;
        return shape;
    }
    const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.primitive];
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& n = mesh.normals[t[i]];
        shape.normals[i] = Vec3d(object.instanced ? object.normalTo(n) : n);
    }
    const auto& [n0, n1, n2] = shape.normals;
    if (dot(n0 + (n1 - n0) * u + (n2 - n0) * v, shape.ng) < 0.0) {
        for (Vec3d& n : shape.normals) n = -n;
    }
    return shape;
}

/// Fills the fields that plain meshes do not have. `turned`: whether the interpolated normal was
/// flipped.
void Surfaces::decorate(const Hit& hit, const std::array<Vec3, 3>& corners, bool turned,
                        SurfacePoint& s) const {
    const SceneObject& object = baked_.objects[hit.object];
    const BakedMesh& mesh = baked_.meshes[object.mesh];
    const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.primitive];
    const float w = 1.0f - hit.u - hit.v;
    s.uv1 = between(mesh.uvs1, t, hit.u, hit.v);
    if (!mesh.colors.empty()) {
        const auto color = [&](std::uint32_t corner) {
            const auto& c = mesh.colors[corner];
            return Rgb{c[0], c[1], c[2]};
        };
        s.color = color(t[0]) * w + color(t[1]) * hit.u + color(t[2]) * hit.v;
    }
    const Material& material = description_.materials[mesh.material];
    const auto axesOfMap = [&](const TextureUse& map) {
        return axesOf(hit, corners, map, turned, s.ns);
    };
    if (material.anisotropy > 0.0f) {
        // The tangents are those of the normal map, if there is one [glTF 2.0, 3.7.2.1].
        const TextureUse& map =
            material.normalTexture ? material.normalTexture : material.anisotropyTexture;
        s.grain = grainAt(s, material, axesOfMap(map));
    }
    if (hasOwnClearcoatNormal(material)) {
        s.clearcoatNs = s.ns;
        const TextureUse& map = material.clearcoatNormalTexture;
        if (hasMap(mesh, map)) {
            s.clearcoatNs = bumped(s, map, material.clearcoatNormalScale, axesOfMap(map));
        }
    }
    if (const TextureUse& map = material.normalTexture; hasMap(mesh, map)) {
        s.ns = bumped(s, map, material.normalScale, axesOfMap(map));
    }
}

/// Axes from the mesh's tangents, else from the map's coordinates; zero if it has neither.
/// `turned`: whether the interpolated normal was flipped to become `ns`.
Surfaces::MapAxes Surfaces::axesOf(const Hit& hit, const std::array<Vec3, 3>& corners,
                                   const TextureUse& map, bool turned, const Vec3& ns) const {
    const SceneObject& object = baked_.objects[hit.object];
    const BakedMesh& mesh = baked_.meshes[object.mesh];
    const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.primitive];
    const std::vector<Vec2>& uvs = mesh.uvsOf(map);
    MapAxes axes{};
    if (!uvs.empty()) {
        axes = MapAxes::byCoordinates(corners, {uvs[t[0]], uvs[t[1]], uvs[t[2]]});
    }
    if (!mesh.tangents.empty()) {
        Vec3 right = mesh.tangentAt(t, hit.u, hit.v);
        bool over = (mesh.tangents[t[0]][3] < 0.0f) != turned;
        if (object.instanced) {
            right = object.vector(right);
            over = over != object.mirrored;
        }
        // If tangents are invalid (zero or NaN), the coordinates determine the axes.
        const Vec3 up = cross(ns, right) * (over ? -1.0f : 1.0f);
        if (lengthSquared(up) > 0.0f) axes = {right, up};
    }
    return axes;
}

/// The direction along which the surface is rougher; its length is the strength.
Vec3 Surfaces::grainAt(const SurfacePoint& point, const Material& m, const MapAxes& axes) const {
    Vec2 direction{1.0f, 0.0f};
    float strength = m.anisotropy;
    if (m.anisotropyTexture) {
        const Rgb texel =
            sampleTexture(description_.textures, m.anisotropyTexture, point.uv, point.uv1).rgb;
        direction = {2.0f * texel.r - 1.0f, 2.0f * texel.g - 1.0f};
        strength *= texel.b;
    }
    const float c = std::cos(m.anisotropyRotation), s = std::sin(m.anisotropyRotation);
    Vec3 tangent = axes.right - point.ns * dot(point.ns, axes.right);
    // Without axes any direction will do, if it is the same everywhere around.
    if (!(lengthSquared(tangent) > 0.0f)) tangent = Frame(point.ns).s;
    tangent = normalize(tangent);
    Vec3 bitangent = cross(point.ns, tangent);
    if (dot(bitangent, axes.up) < 0.0f) bitangent = -bitangent;
    const Vec3 along = tangent * (c * direction.x - s * direction.y) +
                       bitangent * (s * direction.x + c * direction.y);
    const float length2 = lengthSquared(along);
    return (length2 > 0.0f ? along * (1.0f / std::sqrt(length2)) : tangent) * strength;
}

/// Shading normal from a normal map. Its axes are made perpendicular to the interpolated normal.
Vec3 Surfaces::bumped(const SurfacePoint& point, const TextureUse& map, float scale,
                      const MapAxes& axes) const {
    const Vec3 tangent = normalize(axes.right - point.ns * dot(point.ns, axes.right));
    Vec3 bitangent = cross(point.ns, tangent);
    if (dot(bitangent, axes.up) < 0.0f) bitangent = -bitangent;
    const Rgb texel = sampleTexture(description_.textures, map, point.uv, point.uv1).rgb;
    const Vec3 n = tangent * ((2.0f * texel.r - 1.0f) * scale) +
                   bitangent * ((2.0f * texel.g - 1.0f) * scale) +
                   point.ns * (2.0f * texel.b - 1.0f);
    const Vec3 unit = normalize(n);
    // Normals that point below the surface and those of triangles without tangents (NaN) are
    // ignored.
    return dot(unit, point.ng) > 1e-3f ? unit : point.ns;
}

template <class Wanted>
std::vector<std::array<Vec3, 3>> Surfaces::ofObjects(const Wanted& wanted) const {
    std::vector<std::array<Vec3, 3>> all;
    for (const SceneObject& object : baked_.objects) {
        if (!wanted(object)) continue;
        const std::size_t triangles = baked_.meshes[object.mesh].triangles.size();
        for (std::uint32_t k = 0; k < triangles; ++k) all.push_back(baked_.corners(object, k));
    }
    return all;
}

bool Surfaces::any(bool (*wanted)(const Material&)) const {
    return std::ranges::any_of(
        baked_.objects, [&](const SceneObject& object) { return wanted(materialOf(object)); });
}

std::vector<std::array<Vec3, 3>> Surfaces::of(bool (*wanted)(const Material&)) const {
    return ofObjects([&](const SceneObject& object) { return wanted(materialOf(object)); });
}

std::vector<std::array<Vec3, 3>> Surfaces::of(std::size_t material) const {
    return ofObjects(
        [&](const SceneObject& object) { return baked_.meshes[object.mesh].material == material; });
}

bool Surfaces::mostlyHoles(const TriangleAlpha& alpha) const {
    // Centres of a uniform subdivision of the triangle into 64.
    constexpr int kRows = 8;
    int there = 0;
    for (int i = 0; i < kRows; ++i) {
        for (int j = 0; j < 2 * (kRows - i) - 1; ++j) {
            const float third = j % 2 == 0 ? 1.0f / 3.0f : 2.0f / 3.0f;
            const float u = (float(i) + third) / kRows, v = (float(j / 2) + third) / kRows;
            there += alpha.opacity({u, v}) >= 0.5f ? 1 : 0;
        }
    }
    return 2 * there < kRows * kRows;
}

std::vector<std::array<Vec3, 3>> Surfaces::blocking(const ThreadPool& pool) const {
    std::vector<std::vector<std::array<Vec3, 3>>> parts(baked_.objects.size());
    pool.forEach(parts.size(), [&](std::size_t o) {
        const SceneObject& object = baked_.objects[o];
        const BakedMesh& mesh = baked_.meshes[object.mesh];
        if (materialOf(object).pane) return;
        const bool holes = hasHoles(object);
        parts[o].reserve(mesh.triangles.size());
        for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
            if (holes && mostlyHoles(alphaOf(description_, mesh, k))) continue;
            parts[o].push_back(baked_.corners(object, k));
        }
    });
    std::vector<std::array<Vec3, 3>> all;
    all.reserve(baked_.triangles);
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace lacuna

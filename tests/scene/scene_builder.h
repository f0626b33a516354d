// Builds scenes in a few lines of code: meshes, materials, lights and cameras of a
// SceneDescription.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/scene/description.h"
#include "libcore/scene/scene.h"

namespace lacuna::test {

// Transforms --------------------------------------------------------------------------------------

inline Affine translation(Vec3d t) {
    Affine a;
    a.m[3] = t;
    return a;
}
inline Affine scaling(Vec3d s) {
    return {{Vec3d{s.x, 0, 0}, Vec3d{0, s.y, 0}, Vec3d{0, 0, s.z}, Vec3d{}}};
}
/// Right-handed rotation about an axis, which need not be unit.
inline Affine rotation(Vec3d axis, double degrees) {
    const Vec3d k = normalize(axis);
    const double angle = degrees * std::numbers::pi / 180;
    const auto turn = [&](Vec3d v) {
        return v * std::cos(angle) + cross(k, v) * std::sin(angle) +
               k * (dot(k, v) * (1 - std::cos(angle)));
    };
    return {{turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1}), Vec3d{}}};
}

// Meshes ------------------------------------------------------------------------------------------

/// Two triangles with the front on the side of cross(u, v); texture coordinates 0..1 along u, v.
inline Mesh quad(Vec3 corner, Vec3 u, Vec3 v, std::uint32_t material = 0) {
    Mesh m;
    m.positions = {corner, corner + u, corner + u + v, corner + v};
    m.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    m.triangles = {{0, 1, 2}, {0, 2, 3}};
    m.material = material;
    return m;
}

inline Mesh triangle(Vec3 a, Vec3 b, Vec3 c, std::uint32_t material = 0) {
    Mesh m;
    m.positions = {a, b, c};
    m.uvs = {{0, 0}, {1, 0}, {0, 1}};
    m.triangles = {{0, 1, 2}};
    m.material = material;
    return m;
}

/// Appends `b` to `a`. Both or neither must have normals.
inline Mesh joined(Mesh a, const Mesh& b) {
    const auto base = std::uint32_t(a.positions.size());
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
    a.uvs.insert(a.uvs.end(), b.uvs.begin(), b.uvs.end());
    for (const auto& t : b.triangles) {
        a.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
    return a;
}

/// Twelve triangles; the front is outside, or inside for a room.
inline Mesh box(Vec3 low, Vec3 high, std::uint32_t material = 0, bool room = false) {
    const Vec3 d = high - low;
    const Vec3 x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
    const std::pair<Vec3, std::pair<Vec3, Vec3>> sides[6] = {{low, {y, x}}, {low + z, {x, y}},
                                                             {low, {z, y}}, {low + x, {y, z}},
                                                             {low, {x, z}}, {low + y, {z, x}}};
    Mesh m;
    for (const auto& [corner, edges] : sides) {
        const Mesh side = room ? quad(corner, edges.second, edges.first, material)
                               : quad(corner, edges.first, edges.second, material);
        m = m.positions.empty() ? side : joined(m, side);
    }
    return m;
}

// Materials ---------------------------------------------------------------------------------------

inline lacuna::Material matte(Rgb albedo) {
    lacuna::Material m;
    m.baseColor = albedo;
    m.metallic = 0;
    m.specular = 0;
    return m;
}
inline lacuna::Material mirror(Rgb color = Rgb(1.0f)) {
    lacuna::Material m;
    m.baseColor = color;
    m.roughness = 0;
    return m;
}
inline lacuna::Material metal(Rgb color, float roughness) {
    lacuna::Material m = mirror(color);
    m.roughness = roughness;
    return m;
}
inline lacuna::Material plastic(Rgb albedo, float roughness) {
    lacuna::Material m;
    m.baseColor = albedo;
    m.metallic = 0;
    m.roughness = roughness;
    return m;
}
inline lacuna::Material glass(float ior = 1.5f, float roughness = 0) {
    lacuna::Material m;
    m.metallic = 0;
    m.roughness = roughness;
    m.transmission = 1;
    m.ior = ior;
    m.thin = false;
    return m;
}
inline lacuna::Material pane(Rgb color = Rgb(1.0f), float ior = 1.5f) {
    lacuna::Material m = glass(ior);
    m.thin = true;
    m.baseColor = color;
    return m;
}
/// A solid of glass; `absorption` per unit length.
inline lacuna::Material colouredGlass(Rgb absorption, float ior = 1.5f, float roughness = 0) {
    lacuna::Material m = glass(ior, roughness);
    m.absorption = absorption;
    return m;
}
inline lacuna::Material emitter(Rgb radiance, bool twoSided = false, Rgb albedo = Rgb(0.0f)) {
    lacuna::Material m = matte(albedo);
    m.emission = radiance;
    m.doubleSided = twoSided;
    return m;
}

// Cameras and lights ------------------------------------------------------------------------------

inline CameraDescription lookAt(Vec3d from, Vec3d to, double yfovDegrees, Vec3d up = {0, 1, 0}) {
    const Vec3d back = normalize(from - to), right = normalize(cross(up, back));
    CameraDescription c;
    c.name = "camera";
    c.toWorld = {{right, cross(back, right), back, from}};
    c.yfov = yfovDegrees * std::numbers::pi / 180;
    return c;
}
inline PunctualLight pointLight(Vec3d position, Rgb intensity) {
    PunctualLight l;
    l.kind = PunctualLight::Kind::Point;
    l.position = position;
    l.intensity = intensity;
    return l;
}
/// Angles from the axis, in radians.
inline PunctualLight spotLight(Vec3d position, Vec3d direction, Rgb intensity, double inner,
                               double outer) {
    PunctualLight l = pointLight(position, intensity);
    l.kind = PunctualLight::Kind::Spot;
    l.direction = normalize(direction);
    l.innerConeAngle = inner;
    l.outerConeAngle = outer;
    return l;
}
inline PunctualLight directionalLight(Vec3d direction, Rgb irradiance) {
    PunctualLight l;
    l.kind = PunctualLight::Kind::Directional;
    l.direction = normalize(direction);
    l.intensity = irradiance;
    return l;
}

// Textures ----------------------------------------------------------------------------------------

/// 8 x 8 texels of a normal map.
inline Texture waves() {
    Texture t;
    t.width = t.height = 8;
    for (int i = 0; i < 64; ++i) {
        const std::uint8_t texel[] = {std::uint8_t(128 + 20 * ((i * 7) % 5 - 2)),
                                      std::uint8_t(128 + 20 * ((i * 11) % 5 - 2)), 250, 255};
        t.rgba.insert(t.rgba.end(), texel, texel + 4);
    }
    return t;
}

// Scenes ------------------------------------------------------------------------------------------

/// One pool for all scenes of a test run.
inline const ThreadPool& pool() {
    static const ThreadPool p(2);
    return p;
}

/// Collects a SceneDescription; material 0 is grey matte.
class SceneBuilder {
  public:
    SceneBuilder() { add(matte(Rgb(0.5f))); }

    std::uint32_t add(lacuna::Material m) {
        d.materials.push_back(std::move(m));
        return std::uint32_t(d.materials.size() - 1);
    }
    TextureUse add(Texture t) {
        d.textures.push_back(std::move(t));
        TextureUse use;
        use.value = std::int32_t(d.textures.size() - 1);
        return use;
    }
    /// Adds a mesh and its first instance; returns the mesh. A mesh that is used once is baked.
    std::uint32_t add(Mesh m, const Affine& toWorld = {}) {
        d.meshes.push_back(std::move(m));
        const auto mesh = std::uint32_t(d.meshes.size() - 1);
        instance(mesh, toWorld);
        return mesh;
    }
    void instance(std::uint32_t mesh, const Affine& toWorld) {
        d.instances.push_back({mesh, toWorld});
    }
    void add(const PunctualLight& l) { d.lights.push_back(l); }
    void add(CameraDescription c) { d.cameras.push_back(std::move(c)); }
    void environment(const std::string& file, double scale = 1, double rotationDegrees = 0) {
        d.environment = EnvironmentDescription{file, scale, rotationDegrees};
    }

    std::unique_ptr<Scene> build() const { return std::make_unique<Scene>(d, pool()); }

    SceneDescription d;
};

}  // namespace lacuna::test

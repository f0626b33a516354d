#include "libcore/scene/scene.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/image/image_io.h"
#include "libcore/scene/triangle.h"

namespace lacuna {

/// Vertices as rays see them: world space for a mesh that is used once, else the mesh's own space
/// moved to its middle (so that large offsets in the file cost no precision).
struct Scene::WorldMesh {
    std::vector<Vec3> positions;  // one more than there are vertices (accel.h)
    std::vector<Vec3> normals;
    std::vector<std::array<float, 4>> tangents;  // as in the file, but in this mesh's space
    std::vector<Vec2> uvs, uvs1;
    std::vector<std::array<float, 4>> colors;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3> faceNormals;  // world-space meshes only: looked up at every hit
    std::uint32_t material = 0;
    bool plain = true;  ///< neither vertex colours, nor a normal map, nor a second set
    /// Those of bsdfAt that the processor's nearer caches do not hold.
    std::vector<TextureUse> farTextures;

    /// The coordinates by which a texture lies on the mesh; may be empty.
    const std::vector<Vec2>& uvsOf(const TextureUse& use) const {
        return use.secondSet ? uvs1 : uvs;
    }
    Vec3 tangentAt(const std::array<std::uint32_t, 3>& t, float u, float v) const {
        const auto at = [&](std::uint32_t corner) {
            return Vec3{tangents[corner][0], tangents[corner][1], tangents[corner][2]};
        };
        return at(t[0]) * (1.0f - u - v) + at(t[1]) * u + at(t[2]) * v;
    }
};

/// How a normal map lies at a point: the directions, of any length, of the image's right and upper
/// edge.
struct Scene::MapAxes {
    Vec3 right, up;

    /// The directions in which the triangle's texture coordinates grow. glTF's bitangent points to
    /// the image's upper edge, against v [glTF 2.0, 3.9.3].
    static MapAxes byCoordinates(const std::array<Vec3, 3>& corners,
                                 const std::array<Vec2, 3>& uvs) {
        const Vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
        const Vec2 d1 = uvs[1] - uvs[0], d2 = uvs[2] - uvs[0];
        // The determinant's sign is enough: lengths are normalised away.
        const float side = d1.x * d2.y - d2.x * d1.y < 0.0f ? -1.0f : 1.0f;
        return {(e1 * d2.y - e2 * d1.y) * side, (e1 * d2.x - e2 * d1.x) * side};
    }
};

struct Scene::Object {
    std::uint32_t mesh = 0;
    bool instanced = false;
    bool mirrored = false;
    std::array<Vec3, 4> toWorld;  // columns and translation
    std::array<Vec3, 3> normal;   // normalTransform's columns
    std::uint32_t firstLight = kNone;

    Vec3 point(Vec3 p) const {
        return toWorld[0] * p.x + toWorld[1] * p.y + toWorld[2] * p.z + toWorld[3];
    }
    Vec3 vector(Vec3 v) const { return toWorld[0] * v.x + toWorld[1] * v.y + toWorld[2] * v.z; }
    Vec3 normalTo(Vec3 n) const { return normal[0] * n.x + normal[1] * n.y + normal[2] * n.z; }
};

namespace {

struct Box {
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    void add(const Vec3d& p) {
        low = min(low, p);
        high = max(high, p);
    }
    bool empty() const { return !(low.x <= high.x); }
    Vec3d centre() const { return empty() ? Vec3d{} : (low + high) * 0.5; }
};

Box boundsOf(const SceneDescription& scene, const ThreadPool& pool) {
    std::vector<Box> boxes(scene.instances.size());
    pool.forEach(boxes.size(), [&](std::size_t i) {
        const Instance& instance = scene.instances[i];
        for (const Vec3& p : scene.meshes[instance.mesh].positions) {
            boxes[i].add(instance.toWorld.point(Vec3d(p)));
        }
    });
    Box all;
    for (const Box& b : boxes) {
        if (b.empty()) continue;
        all.add(b.low);
        all.add(b.high);
    }
    return all;
}

Vec3d centreOf(const Mesh& mesh) {
    Box box;
    for (const Vec3& p : mesh.positions) box.add(Vec3d(p));
    return box.centre();
}

/// Whether every corner's normal is its face's own: then the face's is enough.
bool isFlat(std::span<const Vec3> positions, std::span<const Vec3> normals,
            std::span<const std::array<std::uint32_t, 3>> triangles) {
    if (normals.empty()) return true;
    for (const auto& t : triangles) {
        const Vec3 ng = triangleNormal(positions[t[0]], positions[t[1]], positions[t[2]]);
        for (const std::uint32_t corner : t) {
            if (lengthSquared(normalize(normals[corner]) - ng) > 1e-12f) return false;
        }
    }
    return true;
}

/// All that a material's BSDF is made of, the base colour first.
std::array<TextureUse, 7> bsdfTextures(const Material& m) {
    return {m.baseColorTexture,         m.metallicRoughnessTexture, m.transmissionTexture,
            m.specularTexture,          m.specularColorTexture,     m.clearcoatTexture,
            m.clearcoatRoughnessTexture};
}

std::vector<TextureUse> farTexturesOf(const Material& m, std::span<const Texture> textures) {
    constexpr std::size_t kNearBytes = 1 << 18;
    std::vector<TextureUse> uses;
    for (const TextureUse& use : bsdfTextures(m)) {
        if (use && textures[std::size_t(use.value)].rgba.size() > kNearBytes) uses.push_back(use);
    }
    return uses;
}

bool usesSecondSet(const Material& m) {
    const auto second = [](const TextureUse& use) { return use && use.secondSet; };
    const std::array<TextureUse, 7> uses = bsdfTextures(m);
    return std::any_of(uses.begin(), uses.end(), second) || second(m.normalTexture) ||
           second(m.emissiveTexture);
}

/// What normals are multiplied with, up to scale: the cofactors, of unit size, on the winding's
/// side.
Affine normalTransform(const Affine& a) {
    const Vec3d columns[3] = {a.normal({1, 0, 0}), a.normal({0, 1, 0}), a.normal({0, 0, 1})};
    double largest = 0.0;
    for (const Vec3d& c : columns) largest = std::max(largest, length(c));
    const double scale = (a.determinant() < 0.0 ? -1.0 : 1.0) / (largest > 0.0 ? largest : 1.0);
    return {{columns[0] * scale, columns[1] * scale, columns[2] * scale, Vec3d{}}};
}

/// Whether rays can be taken into the mesh's space in float: not for a scale of zero (glTF allows
/// it) nor for one whose determinant leaves float's range.
bool canBeInstanced(const Affine& a) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, length(a.m[c]));
    return largest > 1e-10 && largest < 1e10 &&
           std::fabs(a.determinant()) > 1e-6 * largest * largest * largest;
}

}  // namespace

Scene::Scene(SceneDescription description, const ThreadPool& pool)
    : description_(std::move(description)) {
    SceneDescription& d = description_;
    const Box bounds = boundsOf(d, pool);
    centre_ = bounds.centre();
    if (!bounds.empty()) radius_ = float(0.5 * length(bounds.high - bounds.low));
    offsetFloor_ = radius_ / 32.0f;

    // One mesh per distinct use: meshes with one instance move to world space, the others stay.
    std::vector<std::uint32_t> uses(d.meshes.size(), 0);
    for (const Instance& i : d.instances) ++uses[i.mesh];
    for (Instance& i : d.instances) {
        if (uses[i.mesh] == 1 || canBeInstanced(i.toWorld)) continue;
        --uses[i.mesh];
        const auto copy = std::uint32_t(d.meshes.size());
        d.meshes.push_back(Mesh(d.meshes[i.mesh]));
        uses.push_back(1);
        i.mesh = copy;
    }
    meshes_.resize(d.meshes.size());
    objects_.resize(d.instances.size());
    std::vector<Affine> meshTransform(d.meshes.size());  // applied to the mesh's own vertices
    std::vector<bool> mirroredMesh(d.meshes.size(), false);
    for (std::size_t i = 0; i < d.instances.size(); ++i) {
        const Instance& instance = d.instances[i];
        Object& object = objects_[i];
        object.mesh = instance.mesh;
        object.mirrored = instance.toWorld.determinant() < 0.0;
        Affine toWorld = instance.toWorld;
        if (uses[instance.mesh] == 1) {
            toWorld.m[3] -= centre_;
            meshTransform[instance.mesh] = toWorld;
            mirroredMesh[instance.mesh] = object.mirrored;
            continue;
        }
        const Vec3d middle = centreOf(d.meshes[instance.mesh]);
        meshTransform[instance.mesh].m[3] = -middle;
        toWorld.m[3] = toWorld.point(middle) - centre_;
        object.instanced = true;
        for (int c = 0; c < 4; ++c) object.toWorld[c] = Vec3(toWorld.m[c]);
        const Affine normals = normalTransform(toWorld);
        for (int c = 0; c < 3; ++c) object.normal[c] = Vec3(normals.m[c]);
    }

    pool.forEach(d.meshes.size(), [&](std::size_t m) {
        if (uses[m] == 0) return;
        Mesh& from = d.meshes[m];
        WorldMesh& to = meshes_[m];
        const Affine& transform = meshTransform[m];
        to.material = from.material;
        to.positions.reserve(from.positions.size() + 1);
        for (const Vec3& p : from.positions)
            to.positions.push_back(Vec3(transform.point(Vec3d(p))));
        to.positions.push_back({});
        to.normals.reserve(from.normals.size());
        // Unit before the transform and not after it: interpolated first, transformed then, as for
        // an instance.
        const Affine normals = normalTransform(transform);
        for (const Vec3& n : from.normals) {
            to.normals.push_back(Vec3(normals.vector(normalize(Vec3d(n)))));
        }
        to.tangents = std::move(from.tangents);
        for (auto& t : to.tangents) {
            const Vec3 along(transform.vector(normalize(Vec3d{t[0], t[1], t[2]})));
            // A mirror turns the image over, but not the cross product that stands for its up.
            t = {along.x, along.y, along.z, mirroredMesh[m] ? -t[3] : t[3]};
        }
        to.uvs = std::move(from.uvs);
        if (usesSecondSet(d.materials[from.material])) to.uvs1 = std::move(from.uvs1);
        to.colors = std::move(from.colors);
        to.plain = to.colors.empty() && to.uvs1.empty() &&
                   !(d.materials[from.material].normalTexture && !to.uvs.empty());
        to.farTextures = farTexturesOf(d.materials[from.material], d.textures);
        to.triangles = std::move(from.triangles);
        if (mirroredMesh[m]) {
            for (auto& t : to.triangles) std::swap(t[1], t[2]);
        }
        std::erase_if(to.triangles, [&](const auto& t) {
            return triangleNormal(to.positions[t[0]], to.positions[t[1]], to.positions[t[2]]) ==
                   Vec3{};
        });
        if (uses[m] == 1) {
            to.faceNormals.reserve(to.triangles.size());
            for (const auto& t : to.triangles) {
                to.faceNormals.push_back(
                    triangleNormal(to.positions[t[0]], to.positions[t[1]], to.positions[t[2]]));
            }
        }
        if (isFlat(to.positions, to.normals, to.triangles)) to.normals = {};
        from = Mesh{};
    });

    // A mesh without triangles makes Embree objects of no use.
    std::erase_if(objects_, [&](const Object& o) { return meshes_[o.mesh].triangles.empty(); });

    std::vector<EmissiveTriangle> emitters;
    for (std::uint32_t i = 0; i < objects_.size(); ++i) {
        Object& object = objects_[i];
        const WorldMesh& mesh = meshes_[object.mesh];
        triangleCount_ += mesh.triangles.size();
        const Material& material = d.materials[mesh.material];
        if (isBlack(material.emission)) continue;
        object.firstLight = std::uint32_t(emitters.size());
        for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
            EmissiveTriangle e;
            auto triangle = mesh.triangles[k];
            // The front is the image of the mesh's front: for a mirrored instance, which still has
            // the mesh's winding, two corners change places (barycentrics are swapped where it is
            // hit).
            if (object.instanced && object.mirrored) std::swap(triangle[1], triangle[2]);
            for (int c = 0; c < 3; ++c) {
                const Vec3 p = mesh.positions[triangle[c]];
                e.corners[c] = object.instanced ? object.point(p) : p;
                const std::vector<Vec2>& uvs = mesh.uvsOf(material.emissiveTexture);
                const Vec2 uv = uvs.empty() ? Vec2{} : uvs[triangle[c]];
                e.uvs[c] = material.emissiveTexture.at(uv);
            }
            e.radiance = material.emission;
            if (material.emissiveTexture) e.texture = &d.textures[material.emissiveTexture.value];
            e.twoSided = material.doubleSided;
            e.object = i;
            e.primitive = k;
            emitters.push_back(e);
        }
    }

    if (d.environment) {
        environment_ =
            std::make_unique<Environment>(readImage(d.environment->file), d.environment->scale,
                                          d.environment->rotationDegrees, d.environment->file);
    }
    lights_ = std::make_unique<Lights>(std::move(emitters), d.lights, centre_, environment_.get(),
                                       radius_);

    if (std::any_of(d.materials.begin(), d.materials.end(),
                    [](const Material& m) { return !isBlack(m.absorption); })) {
        for (const Material& m : d.materials) absorption_.push_back(m.absorption);
    }

    std::vector<float> iors;
    for (const Material& m : d.materials) {
        // A diffuse base under a dielectric layer; factors of one may be less by their texture.
        const bool diffuse = (m.metallic < 1.0f || m.metallicRoughnessTexture) &&
                             (m.transmission < 1.0f || m.transmissionTexture);
        if (!diffuse || m.specular == 0.0f || m.ior == 1.0f) continue;
        // A coloured texture makes any layer up to the factor's: some tables on the way, each for
        // the layers up to it, so that the base gets at most F0 / 8 too little.
        constexpr int kSteps = 8;
        for (int i = m.specularColorTexture ? 1 : kSteps; i <= kSteps; ++i) {
            iors.push_back(Bsdf::layerIor(m.ior, m.specularColor * (float(i) / kSteps)));
        }
    }
    tables_ = std::make_unique<AlbedoTables>(iors);
    std::vector<bool> vertexColors(d.materials.size());
    for (const WorldMesh& m : meshes_) {
        hasFarTextures_ = hasFarTextures_ || !m.farTextures.empty();
        if (!m.colors.empty()) vertexColors[m.material] = true;
    }
    for (std::size_t i = 0; i < d.materials.size(); ++i) {
        preparedBsdfs_.push_back(prepared(d.materials[i], vertexColors[i]));
    }

    std::vector<AccelMesh> accelMeshes;
    for (const WorldMesh& m : meshes_) accelMeshes.push_back({m.positions, m.triangles});
    std::vector<AccelObject> accelObjects;
    for (const Object& o : objects_) {
        AccelObject a;
        a.mesh = o.mesh;
        a.instanced = o.instanced;
        for (int c = 0; c < 4; ++c) a.toWorld.m[c] = Vec3d(o.toWorld[c]);
        const Material& material = d.materials[meshes_[o.mesh].material];
        a.hasHoles = hasHoles(material, meshes_[o.mesh]);
        accelObjects.push_back(a);
    }
    accel_ = std::make_unique<Accel>(
        accelMeshes, accelObjects,
        [this](const Hit& hit, Vec3 origin, Vec3 direction) {
            return isThere(hit, origin, direction);
        },
        pool);
}

Scene::~Scene() = default;

Camera Scene::makeCamera(const std::string& name, Camera::Film film, Camera::Lens lens) const {
    const auto& cameras = description_.cameras;
    if (cameras.empty()) {
        throw InputError(description_.file +
                         ": expected a perspective camera, found none: add one to the scene");
    }
    std::string names;
    for (const CameraDescription& c : cameras) {
        if (name.empty() || c.name == name) return Camera(c, centre_, film, lens);
        names += (names.empty() ? "'" : ", '") + c.name + "'";
    }
    throw UsageError("--camera: expected one of " + names + ", found '" + name + "'");
}

Vec2 Scene::uvAt(const std::vector<Vec2>& uvs, const std::array<std::uint32_t, 3>& t, float u,
                 float v) {
    if (uvs.empty()) return {};
    return uvs[t[0]] * (1.0f - u - v) + uvs[t[1]] * u + uvs[t[2]] * v;
}

bool Scene::hasHoles(const Material& material, const WorldMesh& mesh) const {
    if (material.alphaMode == Material::Alpha::Opaque) return false;
    if (material.baseAlpha < 1.0f || material.alphaCutoff > 1.0f) return true;
    if (std::any_of(mesh.colors.begin(), mesh.colors.end(),
                    [](const auto& c) { return c[3] < 1.0f; })) {
        return true;
    }
    if (!material.baseColorTexture) return false;
    // Exporters like to call everything BLEND that has an image with an alpha channel.
    const auto& texels = description_.textures[std::size_t(material.baseColorTexture.value)].rgba;
    for (std::size_t i = 3; i < texels.size(); i += 4) {
        if (texels[i] != 255) return true;
    }
    return false;
}

float Scene::opacity(const Hit& hit) const {
    const WorldMesh& mesh = meshes_[objects_[hit.object].mesh];
    const Material& material = description_.materials[mesh.material];
    const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.primitive];
    float alpha = material.baseAlpha;
    if (material.baseColorTexture) {
        const Vec2 uv = uvAt(mesh.uvsOf(material.baseColorTexture), t, hit.u, hit.v);
        alpha *= sample(material.baseColorTexture, uv, uv).alpha;
    }
    if (!mesh.colors.empty()) {
        alpha *= mesh.colors[t[0]][3] * (1.0f - hit.u - hit.v) + mesh.colors[t[1]][3] * hit.u +
                 mesh.colors[t[2]][3] * hit.v;
    }
    if (material.alphaMode == Material::Alpha::Blend) return alpha;
    return alpha >= material.alphaCutoff ? 1.0f : 0.0f;
}

bool Scene::isThere(const Hit& hit, Vec3 origin, Vec3 direction) const {
    const float alpha = opacity(hit);
    if (alpha <= 0.0f || alpha >= 1.0f) return alpha > 0.0f;
    // A share of the rays, which they draw themselves: no state, and the same ray again meets the
    // same surfaces. Every strategy of a path has the same chance at each of its edges and
    // vertices, so that the weights need not know.
    return hashToUniform(
               {std::bit_cast<std::uint32_t>(origin.x), std::bit_cast<std::uint32_t>(origin.y),
                std::bit_cast<std::uint32_t>(origin.z), std::bit_cast<std::uint32_t>(direction.x),
                std::bit_cast<std::uint32_t>(direction.y),
                std::bit_cast<std::uint32_t>(direction.z), hit.object, hit.primitive}) < alpha;
}

void Scene::surfaceAt(const Hit& hit, SurfacePoint& s) const {
    const Object& object = objects_[hit.object];
    const WorldMesh& mesh = meshes_[object.mesh];
    const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.primitive];
    const float w = 1.0f - hit.u - hit.v;
    Vec3 p0 = mesh.positions[t[0]], p1 = mesh.positions[t[1]], p2 = mesh.positions[t[2]];
    if (object.instanced) {
        p0 = object.point(p0);
        p1 = object.point(p1);
        p2 = object.point(p2);
    }
    s.position = p0 * w + p1 * hit.u + p2 * hit.v;
    s.ng = object.instanced ? triangleNormal(p0, p1, p2) : mesh.faceNormals[hit.primitive];
    s.barycentric = {hit.u, hit.v};
    if (object.instanced && object.mirrored) {
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
        // Normals that contradict the winding are turned; ones at a right angle say nothing.
        turned = side < 0.0f;
        if (std::fabs(side) > 1e-3f) s.ns = turned ? -n : n;
    }
    s.uv = uvAt(mesh.uvs, t, hit.u, hit.v);
    s.material = mesh.material;
    s.light = object.firstLight != kNone ? object.firstLight + hit.primitive : kNone;
    s.uv1 = {};
    s.color = Rgb(1.0f);
    if (!mesh.plain) decorate(hit, {p0, p1, p2}, turned, s);
    for (const TextureUse& use : mesh.farTextures) {
        prefetchTexture(description_.textures[std::size_t(use.value)],
                        use.at(use.secondSet ? s.uv1 : s.uv));
    }
}

/// What a plain mesh has not. `turned`: the interpolated normal was.
void Scene::decorate(const Hit& hit, const std::array<Vec3, 3>& corners, bool turned,
                     SurfacePoint& s) const {
    const Object& object = objects_[hit.object];
    const WorldMesh& mesh = meshes_[object.mesh];
    const std::array<std::uint32_t, 3>& t = mesh.triangles[hit.primitive];
    const float w = 1.0f - hit.u - hit.v;
    s.uv1 = uvAt(mesh.uvs1, t, hit.u, hit.v);
    if (!mesh.colors.empty()) {
        const auto color = [&](std::uint32_t corner) {
            const auto& c = mesh.colors[corner];
            return Rgb{c[0], c[1], c[2]};
        };
        s.color = color(t[0]) * w + color(t[1]) * hit.u + color(t[2]) * hit.v;
    }
    const Material& material = description_.materials[mesh.material];
    const std::vector<Vec2>& uvs = mesh.uvsOf(material.normalTexture);
    if (material.normalTexture && !uvs.empty()) {
        MapAxes axes = MapAxes::byCoordinates(corners, {uvs[t[0]], uvs[t[1]], uvs[t[2]]});
        if (!mesh.tangents.empty()) {
            Vec3 right = mesh.tangentAt(t, hit.u, hit.v);
            bool over = (mesh.tangents[t[0]][3] < 0.0f) != turned;
            if (object.instanced) {
                right = object.vector(right);
                over = over != object.mirrored;
            }
            // Tangents that say nothing (zero or NaN) leave it to the coordinates.
            const Vec3 up = cross(s.ns, right) * (over ? -1.0f : 1.0f);
            if (lengthSquared(up) > 0.0f) axes = {right, up};
        }
        s.ns = bumped(s, material.normalTexture, material.normalScale, axes);
    }
}

/// Shading normal by a normal map, whose axes are made perpendicular to the interpolated normal.
Vec3 Scene::bumped(const SurfacePoint& point, const TextureUse& map, float scale,
                   const MapAxes& axes) const {
    const Vec3 tangent = normalize(axes.right - point.ns * dot(point.ns, axes.right));
    Vec3 bitangent = cross(point.ns, tangent);
    if (dot(bitangent, axes.up) < 0.0f) bitangent = -bitangent;
    const Rgb texel = sample(map, point.uv, point.uv1).rgb;
    const Vec3 n = tangent * ((2.0f * texel.r - 1.0f) * scale) +
                   bitangent * ((2.0f * texel.g - 1.0f) * scale) +
                   point.ns * (2.0f * texel.b - 1.0f);
    const Vec3 unit = normalize(n);
    // Normals that lead below the surface, and those of triangles without tangents (NaN), say
    // nothing.
    return dot(unit, point.ng) > 1e-3f ? unit : point.ns;
}

bool Scene::mostlyHoles(std::uint32_t object, std::uint32_t primitive) const {
    // Points in the middle of an even division of the triangle into 64.
    constexpr int kRows = 8;
    int there = 0;
    for (int i = 0; i < kRows; ++i) {
        for (int j = 0; j < 2 * (kRows - i) - 1; ++j) {
            const float third = j % 2 == 0 ? 1.0f / 3.0f : 2.0f / 3.0f;
            const float u = (float(i) + third) / kRows, v = (float(j / 2) + third) / kRows;
            there += opacity({object, primitive, u, v}) >= 0.5f ? 1 : 0;
        }
    }
    return 2 * there < kRows * kRows;
}

std::vector<std::array<Vec3, 3>> Scene::blockingTriangles(const ThreadPool& pool) const {
    std::vector<std::vector<std::array<Vec3, 3>>> parts(objects_.size());
    pool.forEach(objects_.size(), [&](std::size_t o) {
        const Object& object = objects_[o];
        const WorldMesh& mesh = meshes_[object.mesh];
        const bool holes = hasHoles(description_.materials[mesh.material], mesh);
        parts[o].reserve(mesh.triangles.size());
        for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
            if (holes && mostlyHoles(std::uint32_t(o), k)) continue;
            std::array<Vec3, 3> t;
            for (std::size_t c = 0; c < 3; ++c) {
                const Vec3 p = mesh.positions[mesh.triangles[k][c]];
                t[c] = object.instanced ? object.point(p) : p;
            }
            parts[o].push_back(t);
        }
    });
    std::vector<std::array<Vec3, 3>> all;
    all.reserve(triangleCount_);
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

std::optional<Hit> Scene::trace(const Vec3& origin, const Vec3& ng, const Vec3& direction,
                                RayKind kind, RayTally& tally) const {
    ++tally.counts[std::size_t(kind)];
    Ray ray{offsetOrigin(origin, ng, direction, offsetFloor_), direction};
    const std::optional<Hit> hit = accel_->intersect(ray);
    if (tally.recording) {
        if (hit) ray.tFar = hit->distance;
        tally.recording->push_back({ray, kind});
    }
    return hit;
}

std::optional<SurfacePoint> Scene::intersect(const Vec3& origin, const Vec3& ng,
                                             const Vec3& direction, RayKind kind,
                                             RayTally& tally) const {
    const std::optional<Hit> hit = trace(origin, ng, direction, kind, tally);
    if (!hit) return std::nullopt;
    SurfacePoint point;
    surfaceAt(*hit, point);
    return point;
}

bool Scene::visible(const Vec3& a, const Vec3& ngA, const Vec3& b, const Vec3& ngB, RayKind kind,
                    RayTally& tally) const {
    ++tally.counts[std::size_t(kind)];
    const Vec3 direction = b - a;
    const Vec3 from = offsetOrigin(a, ngA, direction, offsetFloor_);
    const Vec3 to = offsetOrigin(b, ngB, -direction, offsetFloor_);
    const Ray ray{from, to - from, 1.0f - 1e-6f};
    if (tally.recording) tally.recording->push_back({ray, kind});
    return !accel_->occluded(ray);
}

bool Scene::visibleToInfinity(const Vec3& a, const Vec3& ngA, const Vec3& direction, RayKind kind,
                              RayTally& tally) const {
    ++tally.counts[std::size_t(kind)];
    const Ray ray{offsetOrigin(a, ngA, direction, offsetFloor_), direction};
    if (tally.recording) tally.recording->push_back({ray, kind});
    return !accel_->occluded(ray);
}

std::uint32_t Scene::materialOf(std::uint32_t light) const {
    return meshes_[objects_[lights_->object(light)].mesh].material;
}

Bsdf Scene::bsdfAt(const SurfacePoint& point) const {
    const PreparedBsdf& common = preparedBsdfs_[point.material];
    if (common.bsdf && !common.colorVaries) return common.bsdf->at(point.ng, point.ns);
    const Material& material = description_.materials[point.material];
    if (common.bsdf) {
        const Rgb color = baseColorAt(material, point.uv, point.uv1) * point.color;
        if (maxComponent(color) > 0.0f) return common.bsdf->at(point.ng, point.ns, color);
    }
    Bsdf::Parameters p = bsdfParameters(material, point.uv, point.uv1);
    p.baseColor *= point.color;
    return Bsdf(p, point.ng, point.ns, *tables_);
}

Scene::PreparedBsdf Scene::prepared(const Material& m, bool vertexColors) const {
    const std::array<TextureUse, 7> uses = bsdfTextures(m);
    if (std::any_of(uses.begin() + 1, uses.end(),
                    [](const TextureUse& use) { return bool(use); })) {
        return {};
    }
    PreparedBsdf out;
    out.colorVaries = m.baseColorTexture || vertexColors;
    Bsdf::Parameters p = bsdfParameters(m, {}, {});
    if (out.colorVaries) p.baseColor = Rgb(1.0f);
    out.bsdf = Bsdf(p, {}, {}, *tables_);
    return out;
}

Rgb Scene::baseColorAt(const Material& m, Vec2 uv, Vec2 uv1) const {
    if (!m.baseColorTexture) return m.baseColor;
    return m.baseColor * sample(m.baseColorTexture, uv, uv1).rgb;
}

Bsdf::Parameters Scene::bsdfParameters(const Material& m, Vec2 uv, Vec2 uv1) const {
    Bsdf::Parameters p;
    p.baseColor = baseColorAt(m, uv, uv1);
    p.metallic = m.metallic;
    p.roughness = m.roughness;
    p.specular = m.specular;
    p.specularColor = m.specularColor;
    p.ior = m.ior;
    p.transmission = m.transmission;
    p.thin = m.thin;
    p.clearcoat = m.clearcoat;
    p.clearcoatRoughness = m.clearcoatRoughness;
    p.without = m.without;
    if (m.metallicRoughnessTexture) {
        const Rgb t = sample(m.metallicRoughnessTexture, uv, uv1).rgb;
        p.roughness *= t.g;
        p.metallic *= t.b;
    }
    if (m.transmissionTexture) {
        p.transmission *= sample(m.transmissionTexture, uv, uv1).rgb.r;
    }
    if (m.specularTexture) {
        p.specular *= sample(m.specularTexture, uv, uv1).alpha;
    }
    if (m.specularColorTexture) {
        p.specularColor *= sample(m.specularColorTexture, uv, uv1).rgb;
    }
    if (m.clearcoatTexture) {
        p.clearcoat *= sample(m.clearcoatTexture, uv, uv1).rgb.r;
    }
    if (m.clearcoatRoughnessTexture) {
        p.clearcoatRoughness *= sample(m.clearcoatRoughnessTexture, uv, uv1).rgb.g;
    }
    return p;
}

}  // namespace lacuna

// (theory.md, "Panes")
#include "libcore/scene/baked.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "libcore/base/parallel.h"
#include "libcore/scene/triangle.h"

namespace lacuna {

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

/// Whether every corner's normal is that of its face within `angle` (a small angle in radians).
/// Then the normal of the face suffices.
bool isFlat(std::span<const Vec3> positions, std::span<const Vec3> normals,
            std::span<const std::array<std::uint32_t, 3>> triangles, float angle) {
    if (normals.empty()) return true;
    for (const auto& t : triangles) {
        const Vec3 ng = triangleNormal(positions[t[0]], positions[t[1]], positions[t[2]]);
        for (const std::uint32_t corner : t) {
            if (lengthSquared(normalize(normals[corner]) - ng) > angle * angle) return false;
        }
    }
    return true;
}

std::vector<TextureUse> farTexturesOf(const Material& m, std::span<const Texture> textures) {
    constexpr std::size_t kNearBytes = 1 << 18;
    std::vector<TextureUse> uses;
    for (const auto texture : kBsdfTextures) {
        const TextureUse& use = m.*texture;
        if (use && textures[std::size_t(use.value)].rgba.size() > kNearBytes) uses.push_back(use);
    }
    return uses;
}

/// The transform of normals up to scale: the cofactor matrix, normalised, on the winding's side.
Affine normalTransform(const Affine& a) {
    const Vec3d columns[3] = {a.normal({1, 0, 0}), a.normal({0, 1, 0}), a.normal({0, 0, 1})};
    double largest = 0.0;
    for (const Vec3d& c : columns) largest = std::max(largest, length(c));
    const double scale = (a.determinant() < 0.0 ? -1.0 : 1.0) / (largest > 0.0 ? largest : 1.0);
    return {{columns[0] * scale, columns[1] * scale, columns[2] * scale, Vec3d{}}};
}

/// Whether rays can be transformed to the mesh's space in float. They cannot for a scale of zero
/// (which glTF allows) or for a determinant beyond the range of float.
bool canBeInstanced(const Affine& a) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, length(a.m[c]));
    return largest > 1e-10 && largest < 1e10 &&
           std::fabs(a.determinant()) > 1e-6 * largest * largest * largest;
}

}  // namespace

std::array<Vec2, 3> BakedMesh::uvsOf(const TextureUse& use, std::uint32_t triangle) const {
    const std::vector<Vec2>& all = uvsOf(use);
    if (all.empty()) return {};
    const std::array<std::uint32_t, 3>& t = triangles[triangle];
    return {all[t[0]], all[t[1]], all[t[2]]};
}

Vec3 BakedMesh::tangentAt(const std::array<std::uint32_t, 3>& t, float u, float v) const {
    const auto at = [&](std::uint32_t corner) {
        return Vec3{tangents[corner][0], tangents[corner][1], tangents[corner][2]};
    };
    return at(t[0]) * (1.0f - u - v) + at(t[1]) * u + at(t[2]) * v;
}

bool BakedMesh::hasVertexAlpha() const {
    return std::any_of(colors.begin(), colors.end(), [](const auto& c) { return c[3] < 1.0f; });
}

namespace {

/// How often a mesh is used, and the transform of its vertices.
struct MeshUse {
    std::uint32_t instances = 0;
    Affine transform;  ///< to world space for one instance, else to the mesh's centre
    bool mirrored = false;
};

/// The uses by mesh. A mesh with several instances is copied for those that Embree cannot instance.
std::vector<MeshUse> countUses(SceneDescription& d) {
    std::vector<MeshUse> uses(d.meshes.size());
    for (const Instance& i : d.instances) ++uses[i.mesh].instances;
    for (Instance& i : d.instances) {
        if (uses[i.mesh].instances == 1 || canBeInstanced(i.toWorld)) continue;
        --uses[i.mesh].instances;
        const auto copy = std::uint32_t(d.meshes.size());
        d.meshes.push_back(Mesh(d.meshes[i.mesh]));
        uses.emplace_back().instances = 1;
        i.mesh = copy;
    }
    return uses;
}

SceneObject place(const Instance& instance, const Mesh& mesh, const Vec3d& centre, MeshUse& use) {
    SceneObject object;
    object.mesh = instance.mesh;
    object.lightGroup = instance.lightGroup;
    object.nodeName = instance.nodeName;
    object.mirrored = instance.toWorld.determinant() < 0.0;
    Affine toWorld = instance.toWorld;
    if (use.instances == 1) {
        toWorld.m[3] -= centre;
        use.transform = toWorld;
        use.mirrored = object.mirrored;
        return object;
    }
    const Vec3d middle = centreOf(mesh);
    use.transform.m[3] = -middle;
    toWorld.m[3] = toWorld.point(middle) - centre;
    object.instanced = true;
    for (std::size_t c = 0; c < 4; ++c) object.toWorld[c] = Vec3(toWorld.m[c]);
    const Affine normals = normalTransform(toWorld);
    for (std::size_t c = 0; c < 3; ++c) object.normal[c] = Vec3(normals.m[c]);
    return object;
}

/// Transforms positions, normals and tangents of the mesh.
void moveVertices(const MeshUse& use, Mesh& from, BakedMesh& to) {
    to.positions.reserve(from.positions.size() + 1);
    for (const Vec3& p : from.positions) {
        to.positions.push_back(Vec3(use.transform.point(Vec3d(p))));
    }
    to.positions.push_back({});
    to.normals.reserve(from.normals.size());
    // Normalised before the transform and not after it, as for an instance: there, normals are
    // interpolated first and then transformed.
    const Affine normals = normalTransform(use.transform);
    for (const Vec3& n : from.normals) {
        to.normals.push_back(Vec3(normals.vector(normalize(Vec3d(n)))));
    }
    to.tangents = std::move(from.tangents);
    for (auto& t : to.tangents) {
        const Vec3 along(use.transform.vector(normalize(Vec3d{t[0], t[1], t[2]})));
        // A mirror flips the image but not the cross product that defines its up direction.
        t = {along.x, along.y, along.z, use.mirrored ? -t[3] : t[3]};
    }
}

/// Tolerances, in radians, between vertex normals and those of their faces: for rounding, and for
/// panes a deviation that is invisible in a window.
constexpr float kFlatness = 1e-6f, kPaneFlatness = 1e-3f;

/// Moves the triangles, reverses their winding if the transform mirrors, and drops degenerate ones.
/// Drops vertex normals if the mesh is flat.
void takeTriangles(const MeshUse& use, float flatness, Mesh& from, BakedMesh& to) {
    const auto normalOf = [&](const std::array<std::uint32_t, 3>& t) {
        return triangleNormal(to.positions[t[0]], to.positions[t[1]], to.positions[t[2]]);
    };
    to.triangles = std::move(from.triangles);
    if (use.mirrored) {
        for (auto& t : to.triangles) std::swap(t[1], t[2]);
    }
    std::erase_if(to.triangles, [&](const auto& t) { return normalOf(t) == Vec3{}; });
    if (use.instances == 1) {
        to.faceNormals.reserve(to.triangles.size());
        for (const auto& t : to.triangles) to.faceNormals.push_back(normalOf(t));
    }
    if (isFlat(to.positions, to.normals, to.triangles, flatness)) to.normals = {};
}

/// Gives flat meshes of thin smooth glass a material of their own that lets rays pass (a pane). Their original material
/// may also be on curved meshes, where the angle to the shading normal differs from that to the face's normal.
void findPanes(SceneDescription& d, std::vector<BakedMesh>& meshes) {
    std::map<std::uint32_t, std::uint32_t> paneOf;
    for (BakedMesh& mesh : meshes) {
        if (mesh.triangles.empty() || !mesh.normals.empty()) continue;
        const Material& material = d.materials[mesh.material];
        if (!mayBePane(material) || mayHaveHoles(material, d.textures, mesh.hasVertexAlpha()))
            continue;
        const auto [found, isNew] = paneOf.try_emplace(mesh.material, d.materials.size());
        if (isNew) {
            Material pane = material;
            pane.pane = true;
            d.materials.push_back(std::move(pane));
        }
        mesh.material = found->second;
    }
}

}  // namespace

BakedScene bake(SceneDescription& d, const ThreadPool& pool) {
    BakedScene out;
    const Box bounds = boundsOf(d, pool);
    out.centre = bounds.centre();
    if (!bounds.empty()) {
        out.halfSize = Vec3((bounds.high - bounds.low) * 0.5);
        out.radius = float(0.5 * length(bounds.high - bounds.low));
    }

    std::vector<MeshUse> uses = countUses(d);
    for (const Instance& instance : d.instances) {
        out.objects.push_back(
            place(instance, d.meshes[instance.mesh], out.centre, uses[instance.mesh]));
    }
    out.meshes.resize(d.meshes.size());
    pool.forEach(d.meshes.size(), [&](std::size_t m) {
        if (uses[m].instances == 0) return;
        Mesh& from = d.meshes[m];
        BakedMesh& to = out.meshes[m];
        const Material& material = d.materials[from.material];
        to.material = from.material;
        moveVertices(uses[m], from, to);
        to.uvs = std::move(from.uvs);
        if (usesSecondSet(material)) to.uvs1 = std::move(from.uvs1);
        to.colors = std::move(from.colors);
        const bool mapped = material.normalTexture && !to.uvs.empty();
        to.plain = to.colors.empty() && to.uvs1.empty() && !mapped && !hasOwnDirections(material);
        to.farTextures = farTexturesOf(material, d.textures);
        takeTriangles(uses[m], mayBePane(material) ? kPaneFlatness : kFlatness, from, to);
        from = Mesh{};
    });
    findPanes(d, out.meshes);

    // Objects without triangles would be useless to Embree.
    std::erase_if(out.objects,
                  [&](const SceneObject& o) { return out.meshes[o.mesh].triangles.empty(); });
    for (const SceneObject& o : out.objects) out.triangles += out.meshes[o.mesh].triangles.size();
    return out;
}

TriangleAlpha alphaOf(const SceneDescription& scene, const BakedMesh& mesh,
                      std::uint32_t triangle) {
    TriangleAlpha alpha;
    alpha.material = &scene.materials[mesh.material];
    if (const TextureUse& use = alpha.material->baseColorTexture) {
        alpha.texture = &scene.textures[std::size_t(use.value)];
        alpha.uvs = mesh.uvsOf(use, triangle);
    }
    if (!mesh.colors.empty()) {
        const std::array<std::uint32_t, 3>& t = mesh.triangles[triangle];
        for (std::size_t i = 0; i < 3; ++i) alpha.corners[i] = mesh.colors[t[i]][3];
    }
    return alpha;
}

}  // namespace lacuna

#include "libcore/gltf/skin.h"

#include <algorithm>
#include <cmath>

#include "libcore/gltf/accessor.h"

namespace lacuna::gltf {
namespace {

/// Inverse of an affine map with a determinant other than 0.
Affine inverseOf(const Affine& a) {
    const double scale = 1.0 / a.determinant();
    const Vec3d x = cross(a.m[1], a.m[2]) * scale, y = cross(a.m[2], a.m[0]) * scale,
                z = cross(a.m[0], a.m[1]) * scale;
    Affine inverse{{Vec3d{x.x, y.x, z.x}, Vec3d{x.y, y.y, z.y}, Vec3d{x.z, y.z, z.z}, Vec3d{}}};
    inverse.m[3] = inverse.vector(a.m[3]) * -1.0;
    return inverse;
}

bool isFiniteMap(const Affine& a) {
    return std::all_of(a.m.begin(), a.m.end(), [](const Vec3d& c) { return isFinite(c); }) &&
           std::isfinite(a.determinant());
}

/// The weighted mean of `transforms`. A vertex's weights need not add up to 1.
Affine blend(const std::vector<Affine>& transforms, const std::array<float, 4>& joints,
             const std::array<float, 4>& weights) {
    const double sum = double(weights[0]) + weights[1] + weights[2] + weights[3];
    if (!(sum > 0.0)) return transforms[std::size_t(joints[0])];
    Affine mean{};
    mean.m.fill(Vec3d{});
    for (std::size_t k = 0; k < 4; ++k) {
        const double share = weights[k] / sum;
        if (share == 0.0) continue;
        const Affine& transform = transforms[std::size_t(joints[k])];
        for (std::size_t i = 0; i < 4; ++i) mean.m[i] = mean.m[i] + transform.m[i] * share;
    }
    return mean;
}

}  // namespace

SkinTable::SkinTable(const Document& document, const std::vector<Placement>& placements)
    : placements_(placements), placementOf_(document.nodes.size(), kNowhere) {
    for (std::size_t i = 0; i < placements.size(); ++i) placementOf_[placements[i].node] = i;
}

std::vector<Affine> SkinTable::jointTransforms(const Document& document, std::size_t skin) const {
    const nlohmann::json& json = document.json["skins"][skin];
    const std::string place = "skins[" + std::to_string(skin) + "]";
    const auto joints = json.find("joints");
    if (joints == json.end() || joints->empty()) {
        refuse(document.file, place + ".joints", "a list of nodes", "none");
    }
    std::vector<float> bind;
    if (const auto matrices = json.find("inverseBindMatrices"); matrices != json.end()) {
        const AccessorView view = viewAccessor(document, matrices->get<int>(), 16);
        if (view.count < joints->size() || !view.base) {
            refuse(document.file, place + ".inverseBindMatrices",
                   std::to_string(joints->size()) + " matrices, as many as joints",
                   view.base ? std::to_string(view.count) : "none");
        }
        bind = readFloats(view);
    }
    std::vector<Affine> transforms;
    for (std::size_t i = 0; i < joints->size(); ++i) {
        const std::size_t at = placementOf_[(*joints)[i].get<std::size_t>()];
        if (at == kNowhere) {
            refuse(document.file, place + ".joints", "nodes of the scene that is rendered",
                   "nodes[" + (*joints)[i].dump() + "]");
        }
        Affine inverseBind;
        if (!bind.empty()) {
            for (std::size_t c = 0; c < 4; ++c) {
                const float* column = &bind[16 * i + 4 * c];
                inverseBind.m[c] = {column[0], column[1], column[2]};
            }
        }
        transforms.push_back(placements_[at].toWorld * inverseBind);
        if (!isFiniteMap(transforms.back())) {
            refuse(document.file, place + ".inverseBindMatrices", "finite matrices",
                   "another one, of joint " + std::to_string(i));
        }
    }
    return transforms;
}

SkinnedMesh SkinTable::bend(Document& document, std::size_t node, const Mesh& mesh,
                            const Influences& influences) const {
    const std::string place = "nodes[" + std::to_string(node) + "].skin";
    const std::size_t bytesOfVertex = sizeof(Vec3) * 2 + sizeof(Vec2) * 2 + sizeof(float) * 8;
    if (!document.allowance.take(mesh.positions.size() * bytesOfVertex +
                                 mesh.triangles.size() * sizeof(mesh.triangles[0]))) {
        refuseUnpacking(document, place);
    }
    const std::vector<Affine> transforms =
        jointTransforms(document, std::size_t(document.nodes[node].skin));
    for (std::size_t i = 0; i < influences.joints.size(); ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            const float joint = influences.joints[i][k];
            if (k > 0 && influences.weights[i][k] == 0.0f) continue;  // its joint is unused
            if (joint >= 0.0f && joint < float(transforms.size())) continue;
            refuse(document.file, place, "joints below " + std::to_string(transforms.size()),
                   std::to_string(std::lround(joint)) + " at vertex " + std::to_string(i));
        }
    }

    SkinnedMesh result{mesh, {}};
    // Where one joint moves all vertices, the mesh stays as it is: no rounding, and the winding is
    // kept under mirroring.
    const Affine& first = transforms[std::size_t(influences.joints[0][0])];
    if (first.determinant() != 0.0 && isFiniteMap(inverseOf(first))) result.toWorld = first;
    const Affine back = inverseOf(result.toWorld);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Affine local = back * blend(transforms, influences.joints[i], influences.weights[i]);
        Vec3& position = result.mesh.positions[i];
        position = Vec3(local.point(Vec3d(position)));
        if (!isFinite(position)) {
            refuse(document.file, place, "finite positions",
                   "another one, of vertex " + std::to_string(i));
        }
        if (!mesh.normals.empty()) {
            const Vec3d normal = local.normal(Vec3d(mesh.normals[i]));
            const double l = length(normal);
            if (l > 0.0 && std::isfinite(l)) result.mesh.normals[i] = Vec3(normal / l);
        }
        if (!mesh.tangents.empty()) {
            auto& t = result.mesh.tangents[i];
            const Vec3 along(local.vector({t[0], t[1], t[2]}));
            if (isFinite(along)) t = {along.x, along.y, along.z, t[3]};
        }
    }
    dropFlatTriangles(result.mesh);
    return result;
}

}  // namespace lacuna::gltf

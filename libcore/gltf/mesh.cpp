#include "libcore/gltf/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "libcore/gltf/accessor.h"
#include "libcore/gltf/in_parallel.h"
#include "libcore/gltf/limits.h"

namespace lacuna::gltf {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// One primitive: the data read, and the counts that the user is warned of.
struct Task {
    std::size_t mesh = 0, primitive = 0;
    Mesh result;
    Influences influences;
    std::size_t flatTriangles = 0, zeroNormals = 0;
    bool skippedMode = false, leftOver = false;

    std::string place() const {
        return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
    }
};

const tinygltf::Primitive& primitiveOf(const Document& document, const Task& task) {
    return document.model.meshes[task.mesh].primitives[task.primitive];
}

/// Number of triangles in `count` vertices or indices of `mode` (4, 5 or 6).
std::size_t triangleCount(int mode, std::size_t count) {
    if (mode == TINYGLTF_MODE_TRIANGLES) return count / 3;
    return count < 3 ? 0 : count - 2;
}

/// Accessor of attribute `name`, or -1.
int attribute(const tinygltf::Primitive& primitive, const char* name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

/// Vertex numbers of triangle `i`, glTF 2.0, 3.7.2.1.
Triangle corners(int mode, std::uint32_t i) {
    switch (mode) {
        case TINYGLTF_MODE_TRIANGLE_STRIP:
            return {i, i + 1 + i % 2, i + 2 - i % 2};
        case TINYGLTF_MODE_TRIANGLE_FAN:
            return {i + 1, i + 2, 0};
        default:
            return {3 * i, 3 * i + 1, 3 * i + 2};
    }
}

/// Reads `accessor` as one V (Vec2, Vec3) per vertex, or per vertex of `which` if that is not
/// empty. Refuses another number of vertices than `count` and values that are not finite.
template <class V, int kComponents>
std::vector<V> readVertices(const Document& document, const Task& task, const char* name,
                            int accessor, std::size_t count,
                            const std::vector<std::uint32_t>& which) {
    static_assert(sizeof(V) == kComponents * sizeof(float));
    const AccessorView view = viewAccessor(document, accessor, kComponents);
    if (view.count != count) {
        refuse(document.file, task.place() + "." + name,
               std::to_string(count) + " elements, as many as POSITION has",
               std::to_string(view.count));
    }
    const std::vector<float> values = which.empty() ? readFloats(view) : readFloats(view, which);
    const auto bad =
        std::find_if_not(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
    if (bad != values.end()) {
        const std::size_t element = std::size_t(bad - values.begin()) / kComponents;
        refuse(document.file, task.place() + "." + name, "finite numbers",
               std::to_string(*bad) + " at vertex " +
                   std::to_string(which.empty() ? element : which[element]));
    }
    std::vector<V> result(values.size() / kComponents);
    std::memcpy(static_cast<void*>(result.data()), values.data(), values.size() * sizeof(float));
    return result;
}

/// Many primitives may share one large vertex buffer of which each uses a part: to read all of it
/// for every primitive would take quadratic time. Returns the vertices used, ascending, and
/// renumbers `indices`. Returns an empty list where (nearly) all are used.
std::vector<std::uint32_t> keepUsed(std::vector<std::uint32_t>& indices, std::size_t vertexCount) {
    if (indices.size() >= vertexCount) return {};
    std::vector<std::uint32_t> which = indices;
    std::sort(which.begin(), which.end());
    which.erase(std::unique(which.begin(), which.end()), which.end());
    for (std::uint32_t& index : indices) {
        index = std::uint32_t(std::lower_bound(which.begin(), which.end(), index) - which.begin());
    }
    return which;
}

/// Twice the area along the winding's normal. In double, differences of floats and their products
/// are nearly exact, so that collinear corners give exactly or nearly zero.
Vec3d areaNormal(const Mesh& mesh, const Triangle& t) {
    const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    return cross(b - a, c - a);
}

/// Replaces zero normals by the sum of the normals of the faces around them, and rescales normals
/// whose squares a float cannot hold.
void repairNormals(Task& task) {
    constexpr double kLeast = 1e-12, kShort = 1e-6, kLong = 1e6;
    Mesh& mesh = task.result;
    std::vector<bool> isZero(mesh.normals.size());
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const Vec3d n(mesh.normals[i]);
        const double l = length(n);
        if (!(l > kLeast)) {
            isZero[i] = true;
            mesh.normals[i] = {};
            ++task.zeroNormals;
        } else if (l < kShort || l > kLong) {
            mesh.normals[i] = Vec3(n / l);
        }
    }
    if (task.zeroNormals == 0) return;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 face(normalize(areaNormal(mesh, t)));
        for (const std::uint32_t v : t) {
            if (!isZero[v]) continue;
            const Vec3 sum = mesh.normals[v] + face;
            if (length(sum) > 1e-3f) mesh.normals[v] = sum;  // else back to back: keep one
        }
    }
}

/// Reads TANGENT where it is used: with normals, and with a normal map, anisotropy or a clearcoat
/// (glTF 2.0, 3.7.2.1).
void readTangents(const Document& document, Task& task, std::size_t count,
                  const std::vector<std::uint32_t>& which) {
    const tinygltf::Primitive& primitive = primitiveOf(document, task);
    const int tangents = attribute(primitive, "TANGENT");
    if (tangents < 0 || primitive.material < 0 || task.result.normals.empty()) return;
    const auto& material = document.model.materials[std::size_t(primitive.material)];
    const bool turns = material.normalTexture.index >= 0 ||
                       material.extensions.contains("KHR_materials_anisotropy") ||
                       material.extensions.contains("KHR_materials_clearcoat");
    if (!turns) return;
    task.result.tangents =
        readVertices<std::array<float, 4>, 4>(document, task, "TANGENT", tangents, count, which);
}

/// COLOR_0 has three or four components; values are clamped to [0, 1].
void readColors(const Document& document, Task& task, int accessor, std::size_t count,
                const std::vector<std::uint32_t>& which) {
    using Color = std::array<float, 4>;
    std::vector<Color>& colors = task.result.colors;
    const int type = document.model.accessors[std::size_t(accessor)].type;
    if (type == TINYGLTF_TYPE_VEC3) {
        for (const Vec3 c :
             readVertices<Vec3, 3>(document, task, "COLOR_0", accessor, count, which)) {
            colors.push_back({c.x, c.y, c.z, 1.0f});
        }
    } else {
        colors = readVertices<Color, 4>(document, task, "COLOR_0", accessor, count, which);
    }
    for (Color& color : colors) {
        for (float& c : color) c = std::clamp(c, 0.0f, 1.0f);
    }
}

/// Reads JOINTS_0 and WEIGHTS_0, if the mesh has both.
void readInfluences(const Document& document, Task& task, std::size_t count,
                    const std::vector<std::uint32_t>& which) {
    using Four = std::array<float, 4>;
    const tinygltf::Primitive& primitive = primitiveOf(document, task);
    const int joints = attribute(primitive, "JOINTS_0");
    const int weights = attribute(primitive, "WEIGHTS_0");
    if (joints < 0 || weights < 0) return;
    task.influences.joints =
        readVertices<Four, 4>(document, task, "JOINTS_0", joints, count, which);
    task.influences.weights =
        readVertices<Four, 4>(document, task, "WEIGHTS_0", weights, count, which);
}

/// Adds the morph targets' displacements to positions or normals (`name`), by the mesh's own
/// weights.
void addMorphs(const Document& document, Task& task, const char* name, std::size_t count,
               const std::vector<std::uint32_t>& which, std::vector<Vec3>& values) {
    const std::vector<double>& weights = document.model.meshes[task.mesh].weights;
    const auto& targets = primitiveOf(document, task).targets;
    for (std::size_t k = 0; k < std::min(weights.size(), targets.size()); ++k) {
        const auto moved = targets[k].find(name);
        if (weights[k] == 0.0 || moved == targets[k].end()) continue;
        const auto moves = readVertices<Vec3, 3>(document, task, name, moved->second, count, which);
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] += moves[i] * float(weights[k]);
            if (isFinite(values[i])) continue;
            refuse(document.file, task.place() + ".targets", "finite sums",
                   "another one, at vertex " + std::to_string(i));
        }
    }
}

void readPrimitive(const Document& document, Task& task) {
    const tinygltf::Primitive& primitive = primitiveOf(document, task);
    const int positions = attribute(primitive, "POSITION");
    const std::size_t vertexCount = viewAccessor(document, positions, 3).count;

    std::vector<std::uint32_t> indices, which;
    std::size_t cornerCount = vertexCount;
    if (primitive.indices >= 0) {
        indices = readIndices(document, primitive.indices);
        cornerCount = indices.size();
        const std::uint32_t largest = *std::max_element(indices.begin(), indices.end());
        if (largest >= vertexCount) {
            refuse(document.file, task.place() + ".indices",
                   "vertex indices below " + std::to_string(vertexCount), std::to_string(largest));
        }
        which = keepUsed(indices, vertexCount);
    }

    Mesh& mesh = task.result;
    mesh.positions =
        readVertices<Vec3, 3>(document, task, "POSITION", positions, vertexCount, which);
    addMorphs(document, task, "POSITION", vertexCount, which, mesh.positions);
    if (const int normals = attribute(primitive, "NORMAL"); normals >= 0) {
        mesh.normals = readVertices<Vec3, 3>(document, task, "NORMAL", normals, vertexCount, which);
        addMorphs(document, task, "NORMAL", vertexCount, which, mesh.normals);
    }
    readInfluences(document, task, vertexCount, which);
    readTangents(document, task, vertexCount, which);
    if (const int uvs = attribute(primitive, "TEXCOORD_0"); uvs >= 0) {
        mesh.uvs = readVertices<Vec2, 2>(document, task, "TEXCOORD_0", uvs, vertexCount, which);
    }
    if (const int uvs = attribute(primitive, "TEXCOORD_1"); uvs >= 0) {
        mesh.uvs1 = readVertices<Vec2, 2>(document, task, "TEXCOORD_1", uvs, vertexCount, which);
    }
    if (const int colors = attribute(primitive, "COLOR_0"); colors >= 0) {
        readColors(document, task, colors, vertexCount, which);
    }
    mesh.material = primitive.material >= 0 ? std::uint32_t(primitive.material)
                                            : std::uint32_t(document.model.materials.size());

    mesh.triangles.resize(triangleCount(primitive.mode, cornerCount));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        Triangle t = corners(primitive.mode, std::uint32_t(i));
        if (!indices.empty()) t = {indices[t[0]], indices[t[1]], indices[t[2]]};
        mesh.triangles[i] = t;
    }
    task.leftOver =
        primitive.mode == TINYGLTF_MODE_TRIANGLES ? cornerCount % 3 != 0 : cornerCount < 3;
    task.flatTriangles = dropFlatTriangles(mesh);
    repairNormals(task);
}

/// Number of elements that a primitive reads without bytes of the file. Indices without a buffer
/// view do not occur here: tinygltf refuses them.
std::size_t zeroElements(const Document& document, const Task& task) {
    const tinygltf::Primitive& primitive = primitiveOf(document, task);
    const std::vector<double>& weights = document.model.meshes[task.mesh].weights;
    std::size_t sum = 0;
    const auto add = [&](const std::map<std::string, int>& attributes) {
        for (const auto& [name, index] : attributes) {
            const tinygltf::Accessor& accessor = document.model.accessors[std::size_t(index)];
            // Clamped to just above the limit: sums must not overflow.
            if (accessor.bufferView < 0) sum += std::min(accessor.count, Limits::kZeroElements + 1);
        }
    };
    add(primitive.attributes);
    for (std::size_t k = 0; k < std::min(weights.size(), primitive.targets.size()); ++k) {
        if (weights[k] != 0.0) add(primitive.targets[k]);
    }
    return sum;
}

/// One task per primitive of the used meshes that has triangles. Refuses a file with too many in
/// total.
std::vector<Task> planTasks(const Document& document, const std::vector<bool>& used) {
    std::vector<Task> tasks;
    std::size_t triangles = 0, zeros = 0;
    for (std::size_t m = 0; m < document.model.meshes.size(); ++m) {
        if (!used[m]) continue;
        for (std::size_t p = 0; p < document.model.meshes[m].primitives.size(); ++p) {
            Task task;
            task.mesh = m;
            task.primitive = p;
            const tinygltf::Primitive& primitive = primitiveOf(document, task);
            const int mode = primitive.mode;
            if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
                refuse(document.file, task.place() + ".mode", "0 to 6", std::to_string(mode));
            }
            task.skippedMode = mode < TINYGLTF_MODE_TRIANGLES;
            if (!task.skippedMode) {
                const int positions = attribute(primitive, "POSITION");
                if (positions < 0) {
                    refuse(document.file, task.place() + ".attributes", "POSITION", "none");
                }
                const int source = primitive.indices >= 0 ? primitive.indices : positions;
                const std::size_t count = document.model.accessors[std::size_t(source)].count;
                const std::size_t more = triangleCount(mode, count);
                if (more > Limits::kTriangles || triangles + more > Limits::kTriangles) {
                    refuse(document.file, task.place(),
                           "at most " + std::to_string(Limits::kTriangles) + " triangles in all",
                           "more", "simplify the scene");
                }
                triangles += more;
                zeros += zeroElements(document, task);
                if (zeros > Limits::kZeroElements) {
                    refuse(document.file, task.place(),
                           "at most " + std::to_string(Limits::kZeroElements) +
                               " elements without a buffer view in all",
                           "more");
                }
            }
            tasks.push_back(std::move(task));
        }
    }
    return tasks;
}

void warnAbout(const Document& document, const Task& task, Warnings& warnings) {
    const tinygltf::Primitive& primitive = primitiveOf(document, task);
    const std::string place = task.place();
    warnings.add("points and lines are not rendered", task.skippedMode, place);
    warnings.add("vertices that do not complete a triangle are ignored", task.leftOver, place);
    warnings.add("triangles without area are dropped", task.flatTriangles, place);
    warnings.add("vertex normals of zero length are replaced by the faces' normals",
                 task.zeroNormals, place);
    warnings.add("joints beyond the first four of a vertex are left out",
                 attribute(primitive, "JOINTS_1") >= 0, place);
    warnings.add("morph targets are rendered at rest: by their mesh's own weights",
                 !primitive.targets.empty(), place);
}

}  // namespace

std::size_t dropFlatTriangles(Mesh& mesh) {
    const auto isFlat = [&](const Triangle& t) {
        return !(float(length(areaNormal(mesh, t))) > 0.0f);
    };
    const auto kept = std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), isFlat);
    const auto dropped = std::size_t(mesh.triangles.end() - kept);
    mesh.triangles.erase(kept, mesh.triangles.end());
    return dropped;
}

MeshTable readMeshes(const Document& document, const std::vector<bool>& used, Warnings& warnings) {
    std::vector<Task> tasks = planTasks(document, used);
    inParallel(tasks, [&](Task& task) {
        if (!task.skippedMode) readPrimitive(document, task);
    });

    MeshTable table;
    table.ofPrimitive.resize(document.model.meshes.size());
    for (Task& task : tasks) {
        warnAbout(document, task, warnings);
        auto& ofPrimitive = table.ofPrimitive[task.mesh];
        if (task.result.triangles.empty()) {
            ofPrimitive.push_back(MeshTable::kNone);
            continue;
        }
        ofPrimitive.push_back(std::uint32_t(table.meshes.size()));
        table.meshes.push_back(std::move(task.result));
        table.influences.push_back(std::move(task.influences));
    }
    return table;
}

}  // namespace lacuna::gltf

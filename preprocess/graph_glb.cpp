#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libcore/base/atomic_file.h"
#include "preprocess/skeletonize.h"

namespace lacuna {

namespace {

using nlohmann::json;

constexpr int kFloat = 5126, kUnsigned = 5125, kArrays = 34962, kIndices = 34963;
constexpr int kLines = 1, kTriangles = 4;

/// The .glb's only buffer, under construction.
class Buffer {
  public:
    /// Adds points and returns the index of their accessor.
    int addPoints(const std::vector<Vec3>& points) {
        constexpr float kFar = std::numeric_limits<float>::infinity();
        Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
        for (const Vec3& p : points) {
            low = min(low, p);
            high = max(high, p);
        }
        const int view = addView(points.data(), points.size() * sizeof(Vec3), kArrays);
        accessors.push_back({{"bufferView", view},
                             {"componentType", kFloat},
                             {"count", points.size()},
                             {"type", "VEC3"},
                             {"min", {low.x, low.y, low.z}},
                             {"max", {high.x, high.y, high.z}}});
        return int(accessors.size()) - 1;
    }
    int addIndices(const std::vector<std::uint32_t>& indices) {
        const int view = addView(indices.data(), indices.size() * sizeof(std::uint32_t), kIndices);
        accessors.push_back({{"bufferView", view},
                             {"componentType", kUnsigned},
                             {"count", indices.size()},
                             {"type", "SCALAR"}});
        return int(accessors.size()) - 1;
    }

    std::string bytes;
    json views = json::array(), accessors = json::array();

  private:
    int addView(const void* data, std::size_t size, int target) {
        views.push_back({{"buffer", 0},
                         {"byteOffset", bytes.size()},
                         {"byteLength", size},
                         {"target", target}});
        bytes.append(static_cast<const char*>(data), size);
        return int(views.size()) - 1;
    }
};

/// Makes a unit sphere of rings and segments.
void makeSphere(std::vector<Vec3>& points, std::vector<std::uint32_t>& indices) {
    constexpr std::uint32_t kRings = 8, kSegments = 16;
    for (std::uint32_t r = 0; r <= kRings; ++r) {
        const double polar = std::numbers::pi * r / kRings;
        for (std::uint32_t s = 0; s < kSegments; ++s) {
            const double around = 2.0 * std::numbers::pi * s / kSegments;
            points.push_back(Vec3(Vec3d{std::sin(polar) * std::cos(around), std::cos(polar),
                                        std::sin(polar) * std::sin(around)}));
        }
    }
    for (std::uint32_t r = 0; r < kRings; ++r) {
        for (std::uint32_t s = 0; s < kSegments; ++s) {
            const std::uint32_t a = r * kSegments + s, b = r * kSegments + (s + 1) % kSegments;
            for (const std::uint32_t i : {a, b, a + kSegments, b, b + kSegments, a + kSegments}) {
                indices.push_back(i);
            }
        }
    }
}

std::string chunk(std::string content, const char* type, char filler) {
    content.resize((content.size() + 3) / 4 * 4, filler);
    const auto size = std::uint32_t(content.size());
    return std::string(reinterpret_cast<const char*>(&size), 4) + std::string(type, 4) + content;
}

}  // namespace

void writeGraphGlb(const std::string& path, const Skeletonized& result, const Vec3d& centre) {
    Buffer buffer;
    json meshes = json::array(), nodes = json::array();
    const auto addMesh = [&](const char* name, int mode, const std::vector<Vec3>& points,
                             const std::vector<std::uint32_t>& indices, int material) {
        const json primitive = {{"mode", mode},
                                {"attributes", {{"POSITION", buffer.addPoints(points)}}},
                                {"indices", buffer.addIndices(indices)},
                                {"material", material}};
        meshes.push_back({{"name", name}, {"primitives", json::array({primitive})}});
        return int(meshes.size()) - 1;
    };
    // Points are relative to the scene's centre, which a node of its own adds, so that floats stay
    // precise.
    std::vector<Vec3> points;
    std::vector<std::uint32_t> indices;
    json children = json::array();
    const auto addLines = [&](const char* name, int material) {
        if (indices.empty()) return;
        children.push_back(nodes.size());
        nodes.push_back(
            {{"name", name}, {"mesh", addMesh(name, kLines, points, indices, material)}});
    };
    for (const SkeletonNode& n : result.raw.nodes) points.push_back(Vec3(n.position));
    for (const auto& e : result.raw.edges) indices.insert(indices.end(), e.begin(), e.end());
    addLines("skeleton", 0);
    points.clear();
    indices.clear();
    for (const FilteredEdge& e : result.file.skeleton.edges) {
        const auto first = std::uint32_t(points.size());
        for (const Vec3d& p : {result.file.skeleton.nodes[e.nodes[0]].position, e.leave, e.enter,
                               result.file.skeleton.nodes[e.nodes[1]].position}) {
            points.push_back(Vec3(p));
        }
        indices.insert(indices.end(),
                       {first, first + 1, first + 1, first + 2, first + 2, first + 3});
    }
    addLines("filtered", 1);
    points.clear();
    indices.clear();
    makeSphere(points, indices);
    const int sphere = addMesh("ball", kTriangles, points, indices, 2);
    for (std::size_t i = 0; i < result.file.skeleton.nodes.size(); ++i) {
        const SkeletonNode& n = result.file.skeleton.nodes[i];
        children.push_back(nodes.size());
        nodes.push_back({{"name", "ball " + std::to_string(i)},
                         {"mesh", sphere},
                         {"translation", {n.position.x, n.position.y, n.position.z}},
                         {"scale", {n.radius, n.radius, n.radius}}});
    }
    const std::size_t root = nodes.size();
    nodes.push_back({{"name", "lacuna skeleton"},
                     {"translation", {centre.x, centre.y, centre.z}},
                     {"children", children}});

    const auto material = [](const char* name, double r, double g, double b, double alpha) {
        return json{{"name", name},
                    {"alphaMode", alpha < 1.0 ? "BLEND" : "OPAQUE"},
                    {"pbrMetallicRoughness",
                     {{"baseColorFactor", {r, g, b, alpha}}, {"metallicFactor", 0.0}}}};
    };
    const json document = {
        {"asset", {{"version", "2.0"}, {"generator", "lacuna-skeletonize"}}},
        {"scene", 0},
        {"scenes", {{{"nodes", {root}}}}},
        {"nodes", nodes},
        {"meshes", meshes},
        {"materials",
         {material("skeleton", 0.9, 0.2, 0.1, 1.0), material("filtered", 0.1, 0.4, 0.9, 1.0),
          material("ball", 0.8, 0.8, 0.3, 0.2)}},
        {"bufferViews", buffer.views},
        {"accessors", buffer.accessors},
        {"buffers", {{{"byteLength", buffer.bytes.size()}}}}};
    const std::string body =
        chunk(document.dump(), "JSON", ' ') + chunk(buffer.bytes, "BIN\0", '\0');
    const std::uint32_t header[3] = {0x46546c67u, 2u, std::uint32_t(12 + body.size())};
    writeFileAtomically(path, std::string(reinterpret_cast<const char*>(header), 12) + body);
}

}  // namespace lacuna

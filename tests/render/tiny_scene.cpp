#include "tests/render/tiny_scene.h"

#include <cstdint>
#include <cstring>

namespace lacuna::test {

namespace {

using nlohmann::json;

std::string base64(const std::vector<float>& values) {
    constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::uint8_t> bytes(values.size() * sizeof(float));
    std::memcpy(bytes.data(), values.data(), bytes.size());
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](std::size_t j) { return j < bytes.size() ? unsigned(bytes[j]) : 0u; };
        const unsigned word = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
        for (unsigned d = 0; d < 4; ++d) {
            text += i + d <= bytes.size() ? kDigits[word >> (18 - 6 * d) & 63u] : '=';
        }
    }
    return text;
}

/// Two triangles a b c, a c d; the winding's front is the side that sees a b c d counter-clockwise.
using Quad = std::array<std::array<float, 3>, 4>;

void addQuad(json& root, const Quad& q, int materialIndex) {
    std::vector<float> positions;
    for (const int corner : {0, 1, 2, 0, 2, 3}) {
        const auto& p = q[std::size_t(corner)];
        positions.insert(positions.end(), p.begin(), p.end());
    }
    std::array<float, 3> low = q[0], high = q[0];
    for (const auto& p : q) {
        for (std::size_t c = 0; c < 3; ++c) {
            low[c] = std::min(low[c], p[c]);
            high[c] = std::max(high[c], p[c]);
        }
    }
    const std::size_t n = root["meshes"].size(), bytes = positions.size() * sizeof(float);
    root["buffers"].push_back(
        {{"byteLength", bytes},
         {"uri", "data:application/octet-stream;base64," + base64(positions)}});
    root["bufferViews"].push_back({{"buffer", n}, {"byteLength", bytes}});
    root["accessors"].push_back({{"bufferView", n},
                                 {"componentType", 5126},
                                 {"type", "VEC3"},
                                 {"count", 6},
                                 {"min", low},
                                 {"max", high}});
    const json primitive{{"attributes", {{"POSITION", n}}}, {"material", materialIndex}};
    root["meshes"].push_back({{"primitives", json::array({primitive})}});
    root["scenes"][0]["nodes"].push_back(root["nodes"].size());
    root["nodes"].push_back({{"mesh", n}});
}

json material(std::array<float, 4> color, float metallic, float roughness) {
    return {{"pbrMetallicRoughness",
             {{"baseColorFactor", color},
              {"metallicFactor", metallic},
              {"roughnessFactor", roughness}}},
            {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0.0}}}}}};
}

}  // namespace

std::string TinyScene::text() const {
    json root;
    root["asset"]["version"] = "2.0";
    if (!generator.empty()) root["asset"]["generator"] = generator;
    root["scene"] = 0;
    root["scenes"].push_back({{"nodes", json::array()}});
    root["nodes"] = root["meshes"] = json::array();
    root["extensionsUsed"].push_back("KHR_materials_specular");
    root["materials"] = {material({0.7f, 0.7f, 0.7f, 1.0f}, 0.0f, 1.0f),   // white
                         material({0.7f, 0.2f, 0.1f, 1.0f}, 0.0f, 1.0f),   // red
                         material({0.9f, 0.8f, 0.5f, 1.0f}, 1.0f, 0.4f),   // rough metal
                         material({0.9f, 0.9f, 0.9f, 1.0f}, 1.0f, 0.0f),   // mirror
                         material({0.0f, 0.0f, 0.0f, 1.0f}, 0.0f, 1.0f)};  // lamp
    if (lamp) root["materials"][4]["emissiveFactor"] = {1.0, 0.9, 0.8};
    addQuad(root, {{{-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}}}, 0);  // floor
    addQuad(root, {{{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}}, 0);      // ceiling
    addQuad(root, {{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}}, 2);  // back
    addQuad(root, {{{-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}}}, 1);  // left
    addQuad(root, {{{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}}, 3);      // right
    addQuad(root,
            {{{-0.4f, 0.98f, -0.4f},  // lamp, faces down
              {0.4f, 0.98f, -0.4f},
              {0.4f, 0.98f, 0.4f},
              {-0.4f, 0.98f, 0.4f}}},
            4);
    if (camera) {
        root["cameras"].push_back(
            {{"name", "eye"},
             {"type", "perspective"},
             {"perspective", {{"yfov", 0.7}, {"aspectRatio", 1.5}, {"znear", 0.01}}}});
        root["scenes"][0]["nodes"].push_back(root["nodes"].size());
        root["nodes"].push_back({{"camera", 0}, {"translation", {0.0, 0.0, 3.0}}});
    }
    if (pointLight) {
        root["extensionsUsed"].push_back("KHR_lights_punctual");
        root["extensions"]["KHR_lights_punctual"]["lights"].push_back(
            {{"type", "point"}, {"intensity", pointIntensity}, {"color", {1.0, 1.0, 1.0}}});
        root["scenes"][0]["nodes"].push_back(root["nodes"].size());
        root["nodes"].push_back({{"translation", {0.3, 0.2, 0.1}},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    }
    if (!lacuna.is_null()) root["scenes"][0]["extras"]["lacuna"] = lacuna;
    if (!environment.empty()) root["scenes"][0]["extras"]["environment"] = environment;
    return root.dump();
}

}  // namespace lacuna::test

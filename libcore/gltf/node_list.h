// The nodes of a glTF file as it lists them. node.h reads their hierarchy.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna::gltf {

/// A node. All indices refer to the file's arrays; kNone: absent.
struct Node {
    static constexpr std::int32_t kNone = -1;

    std::string name;
    std::vector<std::int32_t> children;
    std::int32_t mesh = kNone, camera = kNone, skin = kNone;
    std::int32_t light = kNone;  ///< KHR_lights_punctual
    bool visible = true;         ///< KHR_node_visibility
    /// The accessors of EXT_mesh_gpu_instancing.
    std::int32_t translations = kNone, rotations = kNone, scales = kNone;
    /// Column-major. Empty if translation, rotation (a quaternion x, y, z, w) and scale place the node.
    std::vector<double> matrix;
    Vec3d translation{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> rotation{0, 0, 0, 1};
    nlohmann::json extras;  ///< null if the node has none
};

/// Reads the array `nodes` of a file that obeys the rules of guard.h. Nodes of tinygltf have more than twice the size,
/// and it would parse a second JSON text for them.
std::vector<Node> readNodes(nlohmann::json nodes);

}  // namespace lacuna::gltf

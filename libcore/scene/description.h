// The content of a scene file as plain values in the file's units and coordinates. gltf.h fills it;
// scene.h builds from it a scene for ray tracing.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/scene/material.h"

namespace lacuna {

/// One glTF primitive: triangles only (strips and fans are unrolled), in the mesh's own
/// coordinates.
struct Mesh {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;  ///< empty, or one per position (not necessarily unit)
    /// Empty, or one per position (TANGENT), only together with normals: the direction towards the
    /// right edge of the normal map, and the sign of the direction towards its upper edge,
    /// cross(normal, tangent).
    std::vector<std::array<float, 4>> tangents;
    std::vector<Vec2> uvs;   ///< empty, or one per position (TEXCOORD_0)
    std::vector<Vec2> uvs1;  ///< likewise (TEXCOORD_1)
    /// Empty, or one per position (COLOR_0): linear factors on base colour and alpha.
    std::vector<std::array<float, 4>> colors;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::uint32_t material = 0;
};

struct Instance {
    std::uint32_t mesh = 0;
    Affine toWorld;
    static constexpr std::uint32_t kNoGroup = 0xffffffffu;
    std::uint32_t lightGroup = kNoGroup;  ///< index into SceneDescription::nodeGroups
    static constexpr std::uint32_t kNoName = 0xffffffffu;
    std::uint32_t nodeName = kNoName;  ///< index into SceneDescription::nodeNames
};

/// glTF perspective camera: looks along -Z of its own frame, +Y up.
struct CameraDescription {
    std::string name;
    Affine toWorld;
    double yfov = 0.8;         ///< radians, full vertical angle
    double aspectRatio = 0.0;  ///< width / height; 0: not given
    /// Shift of the picture against the viewing axis, to the right and up, as a fraction of the
    /// picture's larger side.
    std::array<double, 2> shift{};
};

/// KHR_lights_punctual, in world coordinates. Units: W/sr per channel (point, spot); irradiance in
/// W/m^2 perpendicular to the direction (directional).
struct PunctualLight {
    enum class Kind : std::uint8_t { Point, Spot, Directional };
    Kind kind = Kind::Point;
    Rgb intensity;
    Vec3d position;
    Vec3d direction{0, 0, -1};            ///< unit, along the light (spot, directional)
    double innerConeAngle = 0.0;          ///< radians from the axis (spot)
    double outerConeAngle = 0.785;        ///< radians from the axis (spot)
    std::string group;                    ///< the node's group, else the light's name
    std::vector<std::string> names = {};  ///< of its node and of itself, if not empty
};

struct EnvironmentDescription {
    std::string file;  ///< path of a latitude-longitude .exr or .hdr
    double scale = 1.0;
    double rotationDegrees = 0.0;  ///< about +Y
    std::optional<Rgb> colour{};   ///< constant radiance, instead of the file
};

/// The units of a file's punctual lights. Descriptions hold radiometric units, W/sr and W/m^2. The
/// candela and lux of a photometric file are converted by 683 lumens per watt.
enum class LampUnits { Radiometric, Photometric };
constexpr const char* nameOf(LampUnits units) {
    return units == LampUnits::Radiometric ? "radiometric" : "photometric";
}

struct SceneDescription {
    std::string file;
    LampUnits lampUnits = LampUnits::Radiometric;  ///< units in which the file's lights were read
    bool fromBlender = false;                      ///< whether asset.generator says so
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<std::string> nodeGroups;  ///< light groups of nodes with meshes
    std::vector<std::string> nodeNames;   ///< names of nodes with meshes
    std::vector<Material>
        materials;  ///< never empty: glTF's default material is added where needed
    std::vector<Texture> textures;
    std::vector<CameraDescription> cameras;
    std::vector<PunctualLight> lights;
    std::optional<EnvironmentDescription> environment;

    // scene.extras.lacuna
    std::optional<int> width, height, maxDepth;
    std::optional<double> aperture, focus;

    std::string contentHash;            ///< XXH3-128 of all bytes read, in hexadecimal digits
    std::vector<std::string> warnings;  ///< one line each, for the user
    std::map<std::string, double> phaseSeconds;
};

}  // namespace lacuna

// What a scene file says, before anything is built from it: plain values in the file's own units
// and coordinates. gltf.h fills it; scene.h turns it into something rays can be traced in.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/material/lobes.h"

namespace lacuna {

/// 8-bit image, row 0 at the top, texel (x, y) at [(y * width + x) * 4]. `srgb` says how RGB is
/// coded; alpha is always linear.
struct Texture {
    enum class Wrap : std::uint8_t { Repeat, MirroredRepeat, ClampToEdge };

    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    bool srgb = false;
    Wrap wrapU = Wrap::Repeat, wrapV = Wrap::Repeat;
};

/// A texture as a material uses it: index into SceneDescription::textures, or none, and how it lies
/// on the surface (KHR_texture_transform).
struct TextureUse {
    static constexpr std::int32_t kNone = -1;
    std::int32_t value = kNone;
    bool secondSet = false;  ///< the mesh's uvs1 instead of its uvs
    Vec2 uAxis{1, 0}, vAxis{0, 1}, offset{0, 0};

    explicit operator bool() const { return value != kNone; }
    /// Coordinates in the texture, from those of the mesh.
    Vec2 at(Vec2 uv) const { return uAxis * uv.x + vAxis * uv.y + offset; }
};

/// glTF metallic-roughness with the extensions that interface.md names; factors are linear.
struct Material {
    enum class Alpha : std::uint8_t { Opaque, Mask, Blend };

    std::string name;
    Rgb baseColor{1.0f};
    float baseAlpha = 1.0f;
    TextureUse baseColorTexture;  ///< sRGB, times baseColor and baseAlpha
    float metallic = 1.0f;
    float roughness = 1.0f;               ///< GGX alpha = roughness^2; 0 is a perfect mirror
    TextureUse metallicRoughnessTexture;  ///< linear: G = roughness, B = metallic
    float specular = 1.0f;                ///< KHR_materials_specular factor; 0 = exactly Lambert
    TextureUse specularTexture;           ///< linear: alpha
    Rgb specularColor{1.0f};              ///< of the layer along its normal; may be above 1
    TextureUse specularColorTexture;      ///< sRGB
    float clearcoat = 0.0f;  ///< KHR_materials_clearcoat: weight of a layer over everything else
    TextureUse clearcoatTexture;  ///< linear: R
    float clearcoatRoughness = 0.0f;
    TextureUse clearcoatRoughnessTexture;  ///< linear: G
    float ior = 1.5f;
    float transmission = 0.0f;
    TextureUse transmissionTexture;  ///< linear: R
    bool thin = true;                ///< no KHR_materials_volume thickness: no refraction
    Rgb absorption;                  ///< of a solid, per unit of length: exp(-absorption d) is left
    TextureUse normalTexture;        ///< linear: tangent, bitangent, normal as (x + 1) / 2
    float normalScale = 1.0f;        ///< of the first two
    Rgb emission;                    ///< radiance: emissiveFactor x emissiveStrength
    TextureUse emissiveTexture;      ///< sRGB, times emission
    bool doubleSided = false;        ///< emission from both sides (geometry is never culled)
    Alpha alphaMode = Alpha::Opaque;
    float alphaCutoff = 0.5f;
    LobeSet without;  ///< lobes to leave out, whatever the rest says
};

/// One glTF primitive: triangles only (strips and fans are unrolled), in the mesh's own
/// coordinates.
struct Mesh {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;  ///< empty, or one per position (not necessarily unit)
    /// Empty, or one per position (TANGENT), only where there are normals: the direction of the
    /// normal map's right edge, and the sign of its upper one, cross(normal, tangent).
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
};

/// glTF perspective camera: looks along -Z of its own frame, +Y up.
struct CameraDescription {
    std::string name;
    Affine toWorld;
    double yfov = 0.8;         ///< radians, full vertical angle
    double aspectRatio = 0.0;  ///< width / height; 0: not given
};

/// KHR_lights_punctual, in world coordinates. Units 1:1: W/sr per channel (point, spot), irradiance
/// perpendicular to the direction (directional).
struct PunctualLight {
    enum class Kind : std::uint8_t { Point, Spot, Directional };
    Kind kind = Kind::Point;
    Rgb intensity;
    Vec3d position;
    Vec3d direction{0, 0, -1};      ///< unit, the way the light travels (spot, directional)
    double innerConeAngle = 0.0;    ///< radians from the axis (spot)
    double outerConeAngle = 0.785;  ///< radians from the axis (spot)
};

struct EnvironmentDescription {
    std::string file;  ///< path that can be opened, latitude-longitude .exr or .hdr
    double scale = 1.0;
    double rotationDegrees = 0.0;  ///< about +Y
};

struct SceneDescription {
    std::string file;
    bool fromBlender = false;  ///< asset.generator says so
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<Material>
        materials;  ///< never empty: glTF's default material is added where needed
    std::vector<Texture> textures;
    std::vector<CameraDescription> cameras;
    std::vector<PunctualLight> lights;
    std::optional<EnvironmentDescription> environment;

    // scene.extras.lacuna
    std::optional<int> width, height, maxDepth;
    std::optional<double> aperture, focus;

    std::string contentHash;            ///< hex XXH3-128 of all bytes that were read
    std::vector<std::string> warnings;  ///< one line each, for the user
    std::map<std::string, double> phaseSeconds;
};

}  // namespace lacuna

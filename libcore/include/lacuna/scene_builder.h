// A scene from memory: meshes, materials, lamps and cameras, as in glTF 2.0. Units and axes are
// glTF's: +Y up, metres or any other unit, radiance and W/sr unscaled.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

class SceneBuilder {
  public:
    using Index = std::uint32_t;
    using Colour = std::array<double, 3>;  ///< linear Rec. 709
    using Point = std::array<double, 3>;
    /// 4 x 4, column-major; the last row is 0 0 0 1.
    using Transform = std::array<double, 16>;
    static constexpr Transform kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    /// Transform of a camera or lamp at `eye` whose -Z axis points at `target`. Throws UsageError
    /// if `eye` and `target` coincide or `up` is parallel to the view direction.
    static Transform lookAt(const Point& eye, const Point& target, const Point& up = {0, 1, 0});

    SceneBuilder();
    ~SceneBuilder();
    SceneBuilder(SceneBuilder&&) noexcept;
    SceneBuilder& operator=(SceneBuilder&&) noexcept;

    /// Adds a texture of width x height pixels of R, G, B, A, top row first. Its colours are coded
    /// as sRGB where a material uses it as a colour; everything else is linear. Throws UsageError
    /// for another number of bytes.
    Index addTexture(int width, int height, std::span<const std::uint8_t> rgba);

    struct Material {
        std::string name;
        Colour baseColour{1, 1, 1};
        double alpha = 1.0;
        double metallic = 0.0;
        double roughness = 1.0;  ///< alpha of GGX = roughness^2; 0: a perfect mirror or glass
        double specular = 1.0;   ///< strength of a dielectric's reflection; 0: Lambertian
        double ior = 1.5;
        double transmission = 0.0;
        bool solid = false;                ///< a refracting body; else a thin sheet
        Colour attenuation{1, 1, 1};       ///< colour of white light in a body ..
        double attenuationDistance = 0.0;  ///< .. after this distance; 0: no absorption
        double clearcoat = 0.0;
        double clearcoatRoughness = 0.0;
        Colour sheen{0, 0, 0};  ///< colour of the fibres of cloth; black: none
        double sheenRoughness = 0.0;
        double anisotropy = 0.0;           ///< 0 to 1: added roughness along the texture's u
        double anisotropyRotation = 0.0;   ///< radians, from u towards -v
        double diffuseTransmission = 0.0;  ///< transmitted share of the diffuse light
        Colour diffuseTransmissionColour{1, 1, 1};
        Colour emission{0, 0, 0};  ///< radiance
        bool doubleSided = false;  ///< emits from both sides
        enum class Alpha { Opaque, Mask, Blend };
        Alpha alphaMode = Alpha::Opaque;
        double alphaCutoff = 0.5;

        std::optional<Index> baseColourTexture;         ///< sRGB, times baseColour and alpha
        std::optional<Index> metallicRoughnessTexture;  ///< G: roughness, B: metallic
        std::optional<Index> normalTexture;
        double normalScale = 1.0;
        std::optional<Index> emissionTexture;      ///< sRGB, times emission
        std::optional<Index> transmissionTexture;  ///< R
    };
    Index addMaterial(const Material& material);

    struct Mesh {
        std::span<const float> positions;          ///< n x 3
        std::span<const std::uint32_t> triangles;  ///< m x 3, counterclockwise seen from the front
        std::span<const float> normals;            ///< n x 3, or empty: flat shading
        std::span<const float> uvs;                ///< n x 2, or empty; v points down
        std::span<const float> colours;            ///< n x 4 factors of base colour, or empty
        std::optional<Index> material;             ///< none: white, diffuse and specular
    };
    /// Adds a mesh and copies its arrays. Throws UsageError if lengths do not fit or an index is
    /// out of range.
    Index addMesh(const Mesh& mesh);
    /// Places a mesh, any number of times.
    void addInstance(Index mesh, const Transform& toWorld = kIdentity);

    struct Camera {
        std::string name;
        Transform toWorld = kIdentity;  ///< looks along -Z, +Y up
        double yfov = 0.8;              ///< radians, the full vertical angle
        double aspect = 0.0;            ///< width / height; 0: not given
    };
    void addCamera(const Camera& camera);

    struct Lamp {
        enum class Kind { Point, Spot, Directional };
        Kind kind = Kind::Point;
        Colour intensity{1, 1, 1};      ///< W/sr; W/m^2 normal to the rays if Directional
        Transform toWorld = kIdentity;  ///< shines along -Z
        double innerAngle = 0.0;        ///< half angles of a spot, radians
        double outerAngle = 0.7853981633974483;
    };
    void addLamp(const Lamp& lamp);

    /// The scene as a .glb file.
    std::vector<std::uint8_t> glb() const;
    /// Writes the .glb, whole or not at all. Throws RunError.
    void save(const std::string& path) const;

  private:
    struct Content;
    std::unique_ptr<Content> content_;
};

}  // namespace lacuna

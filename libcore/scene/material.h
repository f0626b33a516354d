// Materials and textures as a scene file gives them: plain values. Which textures a BSDF is made
// of, and which kinds of lobes a material may have, is said once, in the tables below.
#pragma once

#include <array>
#include <cstdint>
#include <span>
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
    bool nearest = false;  ///< texels are squares of one colour; else linear between their centres
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

/// glTF metallic-roughness with specular, clearcoat, sheen, anisotropy, ior, transmission, diffuse
/// transmission and volume; factors are linear.
struct Material {
    enum class Alpha : std::uint8_t { Opaque, Mask, Blend };

    std::string name;
    Rgb baseColor{1.0f};
    float baseAlpha = 1.0f;
    TextureUse baseColorTexture;  ///< sRGB, times baseColor and baseAlpha
    float metallic = 1.0f;
    float roughness = 1.0f;               ///< GGX alpha = roughness^2; 0 is a perfect mirror
    TextureUse metallicRoughnessTexture;  ///< linear: G = roughness, B = metallic
    float leastRoughnessTexel = 0.0f;     ///< of its G; the loader finds out
    float specular = 1.0f;                ///< KHR_materials_specular factor; 0 = exactly Lambert
    TextureUse specularTexture;           ///< linear: alpha
    Rgb specularColor{1.0f};              ///< of the layer along its normal; may be above 1
    TextureUse specularColorTexture;      ///< sRGB
    float clearcoat = 0.0f;  ///< KHR_materials_clearcoat: weight of a layer over everything else
    TextureUse clearcoatTexture;  ///< linear: R
    float clearcoatRoughness = 0.0f;
    TextureUse clearcoatRoughnessTexture;       ///< linear: G
    float leastClearcoatRoughnessTexel = 0.0f;  ///< likewise
    TextureUse clearcoatNormalTexture;          ///< as normalTexture; none: the mesh's own normals
    float clearcoatNormalScale = 1.0f;
    Rgb sheenColor;                ///< KHR_materials_sheen; black: none
    TextureUse sheenColorTexture;  ///< sRGB
    float sheenRoughness = 0.0f;
    TextureUse sheenRoughnessTexture;  ///< linear: alpha
    float anisotropy = 0.0f;           ///< KHR_materials_anisotropy: strength
    float anisotropyRotation = 0.0f;   ///< radians from the tangent to the bitangent
    TextureUse anisotropyTexture;  ///< linear: direction as (x + 1) / 2 in R and G; B = strength
    float diffuseTransmission = 0.0f;  ///< KHR_materials_diffuse_transmission: of the diffuse base
    TextureUse diffuseTransmissionTexture;  ///< linear: alpha
    Rgb diffuseTransmissionColor{1.0f};
    TextureUse diffuseTransmissionColorTexture;  ///< sRGB
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
    bool hiddenFromCamera =
        false;                    ///< only the edge at the lens passes it, as if it were not there
    std::string lightGroup = {};  ///< of what emits by it; empty: its name
    LobeSet without;              ///< lobes to leave out, whatever the rest says
    bool pane = false;  ///< rays pass it straight (theory.md, "Panes"); the scene finds out
};

/// The textures that a BSDF is made of, the base colour first. (What turns it is not, and emission.)
inline constexpr std::array kBsdfTextures = {&Material::baseColorTexture,
                                             &Material::metallicRoughnessTexture,
                                             &Material::transmissionTexture,
                                             &Material::specularTexture,
                                             &Material::specularColorTexture,
                                             &Material::clearcoatTexture,
                                             &Material::clearcoatRoughnessTexture,
                                             &Material::sheenColorTexture,
                                             &Material::sheenRoughnessTexture,
                                             &Material::diffuseTransmissionTexture,
                                             &Material::diffuseTransmissionColorTexture};
/// Those that turn it, which need axes on the surface.
inline constexpr std::array kTurningTextures = {
    &Material::normalTexture, &Material::clearcoatNormalTexture, &Material::anisotropyTexture};

/// Whether the clearcoat's normals are not those of what is under it.
bool hasOwnClearcoatNormal(const Material& material);
/// Whether points have directions beside their shading normal: a grain, or the clearcoat's normal.
bool hasOwnDirections(const Material& material);

/// Whether the material asks for any texture by TEXCOORD_1.
bool usesSecondSet(const Material& material);

// What a material may hold anywhere on its surface: textures lower factors, so that they can switch
// lobes off as well as on. Lobes that are left out by force (Material::without) do not count.
bool mayBeDiffuse(const Material& material);
bool mayTransmitDiffusely(const Material& material);
bool hasSheen(const Material& material);
/// Metal, or a dielectric layer over a diffuse base.
bool mayReflect(const Material& material);
bool mayTransmit(const Material& material);
/// Some perfectly smooth reflection or transmission, of lobes that are not left out.
bool mayBeSpecular(const Material& material);
/// Whether every ray that comes by meets it, which those of alpha and panes do not.
bool stopsAllRays(const Material& material);
/// Whether rays go on straight or bent through it, scattered nowhere else.
bool mayBeSmoothGlass(const Material& material);
/// Whether they go on through one narrow lobe, as wide everywhere on the surface (Bsdf::refractsNarrowly).
bool mayBeNarrowGlass(const Material& material);
/// Either of the two, which stops all rays: what next event goes through.
bool mayBeClearGlass(const Material& material);
/// Thin smooth glass and nothing else, with or without a colour: a pane where it is flat.
bool mayBePane(const Material& material);
/// A diffuse base, black or not, under a dielectric layer.
bool mayHaveCoatedBase(const Material& material);

/// A kind of lobes and its name in lists of effects.
struct LobeRow {
    LobeKind kind;
    const char* name;
    bool (*mayHave)(const Material&);
};
/// All kinds, in the order of LobeKind.
std::span<const LobeRow> lobeTable();

}  // namespace lacuna

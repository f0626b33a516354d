// Materials and textures of a scene file as plain values. The tables below alone define which
// textures a BSDF depends on and which kinds of lobes a material may have.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/material/lobes.h"

namespace lacuna {

/// An 8-bit RGBA image, row 0 at the top, texel (x, y) at [(y * width + x) * 4]. `srgb` tells
/// whether RGB is coded as sRGB; alpha is always linear.
struct Texture {
    enum class Wrap : std::uint8_t { Repeat, MirroredRepeat, ClampToEdge };

    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    bool srgb = false;
    Wrap wrapU = Wrap::Repeat, wrapV = Wrap::Repeat;
    bool nearest = false;  ///< texels are squares of one colour; else linear interpolation
};

/// A material's use of a texture: index into SceneDescription::textures, or none, and the transform
/// of coordinates (KHR_texture_transform).
struct TextureUse {
    static constexpr std::int32_t kNone = -1;
    std::int32_t value = kNone;
    bool secondSet = false;  ///< the mesh's uvs1 instead of its uvs
    Vec2 uAxis{1, 0}, vAxis{0, 1}, offset{0, 0};

    explicit operator bool() const { return value != kNone; }
    /// Coordinates in the texture for those of the mesh.
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
    float leastRoughnessTexel = 0.0f;     ///< smallest G in the texture; set by the loader
    float specular = 1.0f;                ///< KHR_materials_specular factor; 0 = Lambertian
    TextureUse specularTexture;           ///< linear: alpha
    Rgb specularColor{1.0f};              ///< at normal incidence; may be above 1
    TextureUse specularColorTexture;      ///< sRGB
    float clearcoat = 0.0f;  ///< KHR_materials_clearcoat: weight of a layer over everything else
    TextureUse clearcoatTexture;  ///< linear: R
    float clearcoatRoughness = 0.0f;
    TextureUse clearcoatRoughnessTexture;       ///< linear: G
    float leastClearcoatRoughnessTexel = 0.0f;  ///< likewise
    TextureUse clearcoatNormalTexture;          ///< like normalTexture; none: the mesh's normals
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
    Rgb absorption;                  ///< of a solid, per unit length: transmits exp(-absorption d)
    TextureUse normalTexture;        ///< linear: tangent, bitangent, normal as (x + 1) / 2
    float normalScale = 1.0f;        ///< scales tangent and bitangent
    Rgb emission;                    ///< radiance: emissiveFactor x emissiveStrength
    TextureUse emissiveTexture;      ///< sRGB, times emission
    bool doubleSided = false;        ///< emission from both sides (geometry is never culled)
    Alpha alphaMode = Alpha::Opaque;
    float alphaCutoff = 0.5f;
    bool hiddenFromCamera = false;  ///< rays with an end at the lens pass it
    std::string lightGroup = {};    ///< of emissive surfaces; empty: its name
    LobeSet without;                ///< lobes to leave out, whatever the other fields are
    bool pane = false;              ///< rays pass it straight (theory.md, "Panes"); set by bake()
};

/// The textures that a BSDF depends on, the base colour first, except those that turn it and
/// emission.
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
/// Textures that turn a BSDF, which need axes on the surface.
inline constexpr std::array kTurningTextures = {
    &Material::normalTexture, &Material::clearcoatNormalTexture, &Material::anisotropyTexture};

/// Whether the clearcoat's normals differ from those of the layers under it.
bool hasOwnClearcoatNormal(const Material& material);
/// Whether points have directions besides their shading normal: a grain, or a clearcoat's normal.
bool hasOwnDirections(const Material& material);

/// Whether any texture of the material uses TEXCOORD_1.
bool usesSecondSet(const Material& material);

// Lobes that a material may have anywhere on its surface. Textures lower factors, so that they can
// switch lobes off as well as on. These functions ignore lobes that are left out
// (Material::without).
bool mayBeDiffuse(const Material& material);
bool mayTransmitDiffusely(const Material& material);
bool hasSheen(const Material& material);
/// Metal, or a dielectric layer over a diffuse base.
bool mayReflect(const Material& material);
bool mayTransmit(const Material& material);
/// Whether it may have perfectly smooth reflection or transmission, without the lobes that are left
/// out.
bool mayBeSpecular(const Material& material);
/// Whether it stops every ray. Materials with alpha and panes do not.
bool stopsAllRays(const Material& material);
/// Whether it may transmit rays, straight or refracted, without scattering.
bool mayBeSmoothGlass(const Material& material);
/// Whether it may transmit by one narrow lobe whose width is constant over the surface (Bsdf::refractsNarrowly).
bool mayBeNarrowGlass(const Material& material);
/// Either of the two, if it stops all rays: next-event estimation can go through it.
bool mayBeClearGlass(const Material& material);
/// Whether it is only thin smooth glass, with or without colour: a pane if the mesh is flat.
bool mayBePane(const Material& material);
/// Whether it may have a diffuse base, black or not, under a dielectric layer.
bool mayHaveCoatedBase(const Material& material);

/// A kind of lobe and its name in lists of effects.
struct LobeRow {
    LobeKind kind;
    const char* name;
    bool (*mayHave)(const Material&);
};
/// All kinds, in the order of LobeKind.
std::span<const LobeRow> lobeTable();

}  // namespace lacuna

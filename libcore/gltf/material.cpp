#include "libcore/gltf/material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libcore/base/number_text.h"
#include "libcore/gltf/extras.h"

namespace lacuna::gltf {
namespace {

using nlohmann::json;

/// Reads one material. Core properties come from tinygltf's struct. Extensions come from the JSON,
/// which keeps their numbers as they are (tinygltf truncates integers there to 32 bits).
class Reader {
  public:
    Reader(const Document& document, std::size_t index, TextureTable& textures, Warnings& warnings)
        : document_(document),
          source_(document.model.materials[index]),
          place_("materials[" + std::to_string(index) + "]"),
          textures_(textures),
          warnings_(warnings) {
        json_ = &document.json["materials"][index];
        extensions_ = member(*json_, "extensions");
    }

    Material read() {
        material_.name = source_.name;
        material_.doubleSided = source_.doubleSided;
        readSurface();
        readEmission();
        readAlpha();
        readSheen();
        readAnisotropy();
        readDiffuseTransmission();
        readTransmission();
        readClearcoat();
        readExtras();
        return std::move(material_);
    }

  private:
    static constexpr double kMostAbsorption = 1e30;  ///< per unit of length

    void readSurface() {
        const tinygltf::PbrMetallicRoughness& pbr = source_.pbrMetallicRoughness;
        material_.baseColor = clampedRgb(pbr.baseColorFactor, "baseColorFactor");
        material_.baseAlpha = clamped(pbr.baseColorFactor[3], 0, 1, "baseColorFactor");
        const json* pbrJson = member(*json_, "pbrMetallicRoughness");
        material_.baseColorTexture = texture(pbrJson, "baseColorTexture", true);
        material_.metallic = clamped(pbr.metallicFactor, 0, 1, "metallicFactor");
        material_.roughness = clamped(pbr.roughnessFactor, 0, 1, "roughnessFactor");
        material_.metallicRoughnessTexture = texture(pbrJson, "metallicRoughnessTexture", false);
        material_.normalTexture = texture(json_, "normalTexture", false);
        material_.normalScale =
            clamped(source_.normalTexture.scale, -1e6, 1e6, "normalTexture.scale");

        if (const json* specular = extension("KHR_materials_specular")) readSpecular(*specular);
        if (const json* ior = extension("KHR_materials_ior")) readIor(number(*ior, "ior", 1.5));
    }

    void readSpecular(const json& specular) {
        constexpr double kMost = 1e6;  // reflectances are clamped to 1 anyway
        material_.specular =
            clamped(number(specular, "specularFactor", 1.0), 0, 1, "specularFactor");
        if (!(material_.specular > 0.0f)) return;
        material_.specularColor = clampedRgb(numbers<3>(specular, "specularColorFactor", {1, 1, 1}),
                                             "specularColorFactor", kMost);
        material_.specularTexture = texture(&specular, "specularTexture", false);
        if (!isBlack(material_.specularColor)) {
            material_.specularColorTexture = texture(&specular, "specularColorTexture", true);
        }
    }

    void readIor(double ior) {
        constexpr double kTotal = 1e3;  // reflects 99.6 % at normal incidence
        if (ior == 0.0) {
            warn("ior 0 (total reflection) is rendered as an index of 1000", true);
            ior = kTotal;
        }
        if (!(ior >= 1.0)) {
            refuse(document_.file, place_ + ".extensions.KHR_materials_ior.ior", "0 or at least 1",
                   numberText(ior), "correct the material");
        }
        material_.ior = clamped(ior, 1, kTotal, "ior");
    }

    void readEmission() {
        double strength = 1.0;
        if (const json* emissive = extension("KHR_materials_emissive_strength")) {
            strength = number(*emissive, "emissiveStrength", 1.0);
            strength = clamped(strength, 0, std::numeric_limits<float>::max(), "emissiveStrength");
        }
        material_.emission = clampedRgb(source_.emissiveFactor, "emissiveFactor") * float(strength);
        if (!isBlack(material_.emission)) {
            material_.emissiveTexture = texture(json_, "emissiveTexture", true);
        }
    }

    void readAlpha() {
        const std::string& mode = source_.alphaMode;
        if (mode == "MASK") {
            material_.alphaMode = Material::Alpha::Mask;
        } else if (mode == "BLEND") {
            material_.alphaMode = Material::Alpha::Blend;
        } else if (mode != "OPAQUE") {
            refuse(document_.file, place_ + ".alphaMode", "OPAQUE, MASK or BLEND",
                   '"' + mode + '"');
        }
        // No upper limit: a cutoff above 1 makes everything vanish, as the specification says.
        material_.alphaCutoff = clamped(source_.alphaCutoff, 0, 1e6, "alphaCutoff");
    }

    void readSheen() {
        const json* sheen = extension("KHR_materials_sheen");
        if (!sheen) return;
        material_.sheenColor =
            clampedRgb(numbers<3>(*sheen, "sheenColorFactor", {0, 0, 0}), "sheenColorFactor");
        if (isBlack(material_.sheenColor)) return;
        material_.sheenColorTexture = texture(sheen, "sheenColorTexture", true);
        material_.sheenRoughness =
            clamped(number(*sheen, "sheenRoughnessFactor", 0.0), 0, 1, "sheenRoughnessFactor");
        if (material_.sheenRoughness > 0.0f) {
            material_.sheenRoughnessTexture = texture(sheen, "sheenRoughnessTexture", false);
        }
    }

    void readAnisotropy() {
        const json* anisotropy = extension("KHR_materials_anisotropy");
        if (!anisotropy) return;
        material_.anisotropy =
            clamped(number(*anisotropy, "anisotropyStrength", 0.0), 0, 1, "anisotropyStrength");
        if (!(material_.anisotropy > 0.0f)) return;
        constexpr double kMost = 1e6;  // radians
        material_.anisotropyRotation = clamped(number(*anisotropy, "anisotropyRotation", 0.0),
                                               -kMost, kMost, "anisotropyRotation");
        material_.anisotropyTexture = texture(anisotropy, "anisotropyTexture", false);
    }

    void readDiffuseTransmission() {
        const json* through = extension("KHR_materials_diffuse_transmission");
        if (!through) return;
        material_.diffuseTransmission = clamped(number(*through, "diffuseTransmissionFactor", 0.0),
                                                0, 1, "diffuseTransmissionFactor");
        if (!(material_.diffuseTransmission > 0.0f)) return;
        material_.diffuseTransmissionTexture =
            texture(through, "diffuseTransmissionTexture", false);
        material_.diffuseTransmissionColor =
            clampedRgb(numbers<3>(*through, "diffuseTransmissionColorFactor", {1, 1, 1}),
                       "diffuseTransmissionColorFactor");
        if (!isBlack(material_.diffuseTransmissionColor)) {
            material_.diffuseTransmissionColorTexture =
                texture(through, "diffuseTransmissionColorTexture", true);
        }
    }

    void readTransmission() {
        if (const json* transmission = extension("KHR_materials_transmission")) {
            material_.transmission = clamped(number(*transmission, "transmissionFactor", 0.0), 0, 1,
                                             "transmissionFactor");
            if (material_.transmission > 0.0f) {
                material_.transmissionTexture = texture(transmission, "transmissionTexture", false);
            }
        }
        if (const json* volume = extension("KHR_materials_volume")) {
            material_.thin = !(number(*volume, "thicknessFactor", 0.0) > 0.0);
            warn("thickness textures are not rendered", volume->contains("thicknessTexture"));
            readAbsorption(*volume);
        }
    }

    /// Absorption such that white light has the colour attenuationColor after attenuationDistance.
    void readAbsorption(const json& volume) {
        constexpr double kNever = std::numeric_limits<double>::infinity();
        const auto color = numbers<3>(volume, "attenuationColor", {1, 1, 1});
        const double distance = number(volume, "attenuationDistance", kNever);
        warn("attenuationDistance 0 is not a distance: nothing is absorbed", !(distance > 0.0));
        const bool entered = material_.transmission > 0.0f || material_.diffuseTransmission > 0.0f;
        if (material_.thin || !entered) return;
        if (!(distance > 0.0) || distance == kNever) return;
        const auto coefficient = [&](double c) {
            const auto left = double(clamped(c, 0, 1, "attenuationColor"));
            // Black would absorb without limit; the coefficient must stay finite.
            return float(std::min(-std::log(left) / distance, kMostAbsorption));
        };
        material_.absorption = {coefficient(color[0]), coefficient(color[1]),
                                coefficient(color[2])};
    }

    void readClearcoat() {
        const json* coat = extension("KHR_materials_clearcoat");
        if (!coat) return;
        material_.clearcoat =
            clamped(number(*coat, "clearcoatFactor", 0.0), 0, 1, "clearcoatFactor");
        if (!(material_.clearcoat > 0.0f)) return;
        material_.clearcoatTexture = texture(coat, "clearcoatTexture", false);
        material_.clearcoatRoughness = clamped(number(*coat, "clearcoatRoughnessFactor", 0.0), 0, 1,
                                               "clearcoatRoughnessFactor");
        if (material_.clearcoatRoughness > 0.0f) {
            material_.clearcoatRoughnessTexture = texture(coat, "clearcoatRoughnessTexture", false);
        }
        material_.clearcoatNormalTexture = texture(coat, "clearcoatNormalTexture", false);
        if (material_.clearcoatNormalTexture) {
            material_.clearcoatNormalScale =
                clamped(number((*coat)["clearcoatNormalTexture"], "scale", 1.0), -1e6, 1e6,
                        "clearcoatNormalTexture.scale");
        }
    }

    void readExtras() {
        const json* extras = member(*json_, "extras");
        if (!extras) return;
        const json lacuna = lacunaExtras(document_, *extras, place_);
        material_.lightGroup = lightGroupOf(document_, lacuna, place_);
        const json* hidden = member(lacuna, "hidden_from_camera");
        if (!hidden) return;
        if (!hidden->is_boolean()) {
            refuse(document_.file, place_ + ".extras.lacuna.hidden_from_camera", "true or false",
                   printable(hidden->dump(), 60));
        }
        material_.hiddenFromCamera = hidden->get<bool>();
    }

    static const json* member(const json& object, const char* name) {
        const auto found = object.find(name);
        return found == object.end() ? nullptr : &*found;
    }
    /// The extension's object, or null.
    const json* extension(const char* name) const {
        return extensions_ ? member(*extensions_, name) : nullptr;
    }

    double number(const json& object, const char* name, double otherwise) const {
        const auto found = object.find(name);
        if (found == object.end()) return otherwise;
        if (!found->is_number()) {
            refuse(document_.file, place_ + ".extensions..." + name, "a number",
                   printable(found->dump(), 60));
        }
        return found->get<double>();
    }

    template <std::size_t N>
    std::array<double, N> numbers(const json& object, const char* name,
                                  std::array<double, N> otherwise) const {
        const auto found = object.find(name);
        if (found == object.end()) return otherwise;
        const bool right =
            found->is_array() && found->size() == N &&
            std::all_of(found->begin(), found->end(), [](const json& c) { return c.is_number(); });
        if (!right) {
            refuse(document_.file, place_ + ".extensions..." + name, std::to_string(N) + " numbers",
                   printable(found->dump(), 60));
        }
        std::array<double, N> result;
        for (std::size_t i = 0; i < N; ++i) result[i] = (*found)[i].get<double>();
        return result;
    }

    float clamped(double value, double least, double most, const char* name) {
        const double legal = std::clamp(value, least, most);
        if (legal != value) {
            warnings_.add("material factors outside their legal range are clamped", 1,
                          place_ + "." + name);
        }
        return float(legal);
    }

    /// Three factors clamped to [0, `most`]; a fourth number is ignored.
    template <class Numbers>
    Rgb clampedRgb(const Numbers& factors, const char* name, double most = 1.0) {
        return {clamped(factors[0], 0, most, name), clamped(factors[1], 0, most, name),
                clamped(factors[2], 0, most, name)};
    }

    /// The texture in the member `name` of `object` (may be null). rules.cpp has checked the range
    /// of index and set.
    TextureUse texture(const json* object, const char* name, bool srgb) {
        const json* info = object ? member(*object, name) : nullptr;
        if (!info) return {};
        const json* index = info->is_object() ? member(*info, "index") : nullptr;
        if (!index) {
            refuse(document_.file, place_ + "..." + name, "a texture index", "none");
        }
        TextureUse use = textures_.request(index->get<int>(), srgb, warnings_);
        double set = info->value("texCoord", 0);
        const json* extensions = member(*info, "extensions");
        const json* transform = extensions && extensions->is_object()
                                    ? member(*extensions, "KHR_texture_transform")
                                    : nullptr;
        if (transform) {
            if (!transform->is_object()) {
                refuse(document_.file, place_ + "..." + name + "...KHR_texture_transform",
                       "an object", printable(transform->dump(), 60));
            }
            place(*transform, use);
            set = number(*transform, "texCoord", set);
        }
        use.secondSet = set == 1.0;
        warn("texture coordinate sets above 1 are not rendered: set 0 is used",
             set != 0.0 && set != 1.0);
        return use;
    }

    /// KHR_texture_transform: coordinates are scaled, rotated about the origin and translated.
    /// Positive angles rotate them counterclockwise as the image is seen; v points down.
    void place(const json& transform, TextureUse& use) {
        constexpr double kMost = 1e6;
        const auto scale = numbers<2>(transform, "scale", {1, 1});
        const auto offset = numbers<2>(transform, "offset", {0, 0});
        const double angle = number(transform, "rotation", 0.0);
        const double c = std::cos(angle), s = std::sin(angle);
        const float su = clamped(scale[0], -kMost, kMost, "scale");
        const float sv = clamped(scale[1], -kMost, kMost, "scale");
        use.uAxis = Vec2{float(c), float(-s)} * su;
        use.vAxis = Vec2{float(s), float(c)} * sv;
        use.offset = {clamped(offset[0], -kMost, kMost, "offset"),
                      clamped(offset[1], -kMost, kMost, "offset")};
    }

    void warn(const char* kind, bool applies) { warnings_.add(kind, applies, place_); }

    const Document& document_;
    const tinygltf::Material& source_;
    std::string place_;
    TextureTable& textures_;
    Warnings& warnings_;
    const json* json_ = nullptr;
    const json* extensions_ = nullptr;  // of the material
    Material material_;
};

}  // namespace

std::vector<Material> readMaterials(const Document& document, TextureTable& textures,
                                    Warnings& warnings) {
    std::vector<Material> materials;
    for (std::size_t i = 0; i < document.model.materials.size(); ++i) {
        materials.push_back(Reader(document, i, textures, warnings).read());
    }
    return materials;
}

}  // namespace lacuna::gltf

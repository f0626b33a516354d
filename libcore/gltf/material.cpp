#include "libcore/gltf/material.h"

#include <algorithm>
#include <array>
#include <limits>

namespace lacuna::gltf {
namespace {

using nlohmann::json;

/// Reads one material. Core properties come from tinygltf's struct, extensions from the JSON, which
/// keeps their numbers as they are (tinygltf cuts integers to 32 bits there).
class Reader {
  public:
    Reader(const Document& document, std::size_t index, TextureTable& textures, Warnings& warnings)
        : document_(document),
          source_(document.model.materials[index]),
          place_("materials[" + std::to_string(index) + "]"),
          textures_(textures),
          warnings_(warnings) {
        const json& material = document.json["materials"][index];
        const auto extensions = material.find("extensions");
        if (extensions != material.end()) extensions_ = &*extensions;
    }

    Material read() {
        material_.name = source_.name;
        material_.doubleSided = source_.doubleSided;
        readSurface();
        readEmission();
        readAlpha();
        readTransmission();
        warnAboutRest();
        return std::move(material_);
    }

  private:
    void readSurface() {
        const tinygltf::PbrMetallicRoughness& pbr = source_.pbrMetallicRoughness;
        material_.baseColor = clampedRgb(pbr.baseColorFactor, "baseColorFactor");
        material_.baseAlpha = clamped(pbr.baseColorFactor[3], 0, 1, "baseColorFactor");
        material_.baseColorTexture = texture(pbr.baseColorTexture, true);
        material_.metallic = clamped(pbr.metallicFactor, 0, 1, "metallicFactor");
        material_.roughness = clamped(pbr.roughnessFactor, 0, 1, "roughnessFactor");
        material_.metallicRoughnessTexture = texture(pbr.metallicRoughnessTexture, false);

        if (const json* specular = extension("KHR_materials_specular")) {
            material_.specular =
                clamped(number(*specular, "specularFactor", 1.0), 0, 1, "specularFactor");
            const auto color = numbers3(*specular, "specularColorFactor", 1.0);
            const bool tinted =
                std::any_of(color.begin(), color.end(), [](double c) { return c != 1.0; });
            warn("specularColorFactor is not rendered yet", tinted);
            warn("specular textures are not rendered yet",
                 specular->contains("specularTexture") ||
                     specular->contains("specularColorTexture"));
        }
        if (const json* ior = extension("KHR_materials_ior")) readIor(number(*ior, "ior", 1.5));
    }

    void readIor(double ior) {
        constexpr double kTotal = 1e3;  // reflects 99.6 % at normal incidence
        if (ior == 0.0) {
            warn("ior 0 (total reflection) is rendered as an index of 1000", true);
            ior = kTotal;
        }
        if (!(ior >= 1.0)) {
            refuse(document_.file, place_ + ".extensions.KHR_materials_ior.ior", "0 or at least 1",
                   std::to_string(ior), "correct the material");
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
            material_.emissiveTexture = texture(source_.emissiveTexture, true);
        }
    }

    void readAlpha() {
        const std::string& mode = source_.alphaMode;
        if (mode == "MASK") {
            material_.alphaMode = Material::Alpha::Mask;
        } else if (mode == "BLEND") {
            material_.alphaMode = Material::Alpha::Blend;
            warn("alphaMode BLEND is rendered opaque for now", true);
        } else if (mode != "OPAQUE") {
            refuse(document_.file, place_ + ".alphaMode", "OPAQUE, MASK or BLEND",
                   '"' + mode + '"');
        }
        // No upper limit: a cutoff above 1 makes everything vanish, as the specification says.
        material_.alphaCutoff = clamped(source_.alphaCutoff, 0, 1e6, "alphaCutoff");
    }

    void readTransmission() {
        if (const json* transmission = extension("KHR_materials_transmission")) {
            material_.transmission = clamped(number(*transmission, "transmissionFactor", 0.0), 0, 1,
                                             "transmissionFactor");
            if (material_.transmission > 0.0f) {
                material_.transmissionTexture =
                    extensionTexture(*transmission, "transmissionTexture", false);
            }
        }
        if (const json* volume = extension("KHR_materials_volume")) {
            material_.thin = !(number(*volume, "thicknessFactor", 0.0) > 0.0);
            const auto color = numbers3(*volume, "attenuationColor", 1.0);
            const bool attenuates =
                volume->contains("attenuationDistance") &&
                std::any_of(color.begin(), color.end(), [](double c) { return c != 1.0; });
            warn("attenuation in volumes is not rendered yet", attenuates && !material_.thin);
            warn("thickness textures are not rendered", volume->contains("thicknessTexture"));
        }
    }

    void warnAboutRest() {
        warn("normal maps are not rendered yet", source_.normalTexture.index >= 0);
        if (const json* coat = extension("KHR_materials_clearcoat")) {
            warn("clearcoat is not rendered yet", number(*coat, "clearcoatFactor", 0.0) > 0.0);
        }
    }

    /// The extension's object, or null.
    const json* extension(const char* name) const {
        if (!extensions_) return nullptr;
        const auto found = extensions_->find(name);
        return found == extensions_->end() ? nullptr : &*found;
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

    std::array<double, 3> numbers3(const json& object, const char* name, double otherwise) const {
        const auto found = object.find(name);
        if (found == object.end()) return {otherwise, otherwise, otherwise};
        const bool right =
            found->is_array() && found->size() == 3 &&
            std::all_of(found->begin(), found->end(), [](const json& c) { return c.is_number(); });
        if (!right) {
            refuse(document_.file, place_ + ".extensions..." + name, "3 numbers",
                   printable(found->dump(), 60));
        }
        return {(*found)[0].get<double>(), (*found)[1].get<double>(), (*found)[2].get<double>()};
    }

    float clamped(double value, double least, double most, const char* name) {
        const double legal = std::clamp(value, least, most);
        if (legal != value) {
            warnings_.add("material factors outside their legal range are clamped", 1,
                          place_ + "." + name);
        }
        return float(legal);
    }

    Rgb clampedRgb(const std::vector<double>& factors, const char* name) {
        return {clamped(factors[0], 0, 1, name), clamped(factors[1], 0, 1, name),
                clamped(factors[2], 0, 1, name)};
    }

    TextureIndex texture(const tinygltf::TextureInfo& info, bool srgb) {
        if (info.index < 0) return {};
        warn("texture coordinate sets other than 0 are not rendered yet: set 0 is used",
             info.texCoord != 0);
        const auto transform = info.extensions.find("KHR_texture_transform");
        warn("texture transforms are not rendered yet",
             transform != info.extensions.end() && !isIdentity(transform->second));
        return textures_.request(info.index, srgb, warnings_);
    }

    TextureIndex extensionTexture(const json& object, const char* name, bool srgb) {
        const auto found = object.find(name);
        if (found == object.end()) return {};
        const auto index = found->find("index");
        if (!found->is_object() || index == found->end()) {
            refuse(document_.file, place_ + ".extensions..." + name, "a texture index", "none");
        }
        tinygltf::TextureInfo info;  // both were range-checked (rules.cpp)
        info.index = index->get<int>();
        info.texCoord = found->value("texCoord", 0);
        const auto extensions = found->find("extensions");
        if (extensions != found->end() && extensions->contains("KHR_texture_transform")) {
            info.extensions["KHR_texture_transform"] = tinygltf::Value(1);  // not the identity
        }
        return texture(info, srgb);
    }

    /// Exporters write the transform's defaults; then there is nothing to warn about.
    static bool isIdentity(const tinygltf::Value& transform) {
        const auto is = [&](const char* name, std::size_t i, double value) {
            if (!transform.Has(name)) return true;
            const tinygltf::Value& v = transform.Get(name);
            if (!v.IsArray()) return v.IsNumber() && v.GetNumberAsDouble() == value;
            return i < v.ArrayLen() && v.Get(int(i)).IsNumber() &&
                   v.Get(int(i)).GetNumberAsDouble() == value;
        };
        return transform.IsObject() && is("offset", 0, 0) && is("offset", 1, 0) &&
               is("scale", 0, 1) && is("scale", 1, 1) && is("rotation", 0, 0) &&
               is("texCoord", 0, 0);
    }

    void warn(const char* kind, bool applies) { warnings_.add(kind, applies, place_); }

    const Document& document_;
    const tinygltf::Material& source_;
    std::string place_;
    TextureTable& textures_;
    Warnings& warnings_;
    const json* extensions_ = nullptr;
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

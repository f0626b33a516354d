#include "libcore/gltf/blender.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>

#include "libcore/gltf/entities.h"

namespace lacuna::gltf {
namespace {

using nlohmann::json;

constexpr double kSphere = 4.0 * std::numbers::pi;

/// Whether a double is a float but for the rounding of a few multiplications in double.
bool wasFloat(double value) {
    constexpr double kRounding = 1e-14;  // relative; floats differ by 6e-8 at least
    const double nearest = double(float(value));
    return std::isfinite(nearest) && nearest > 0.0 &&
           std::abs(value - nearest) <= kRounding * nearest;
}

std::string floatText(double value) {
    char buffer[32];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, float(value)).ptr);
}

/// Whether a user may have typed this number: at most four digits, wherever its point is.
bool isRound(double value) {
    char buffer[32];
    const char* end =
        std::to_chars(buffer, buffer + sizeof buffer, float(value), std::chars_format::scientific)
            .ptr;
    const std::string_view text(buffer, std::size_t(end - buffer));
    const std::string_view digits = text.substr(0, text.find('e'));
    return digits.size() <= std::string_view("1.234").size();
}

/// Power in the file's units: W for points and spots, W/m^2 for suns.
double power(const BlenderLamp& lamp) {
    return lamp.isSun ? lamp.intensity : lamp.intensity * kSphere;
}

bool fitsUnitless(const BlenderLamp& lamp) {
    return wasFloat(power(lamp));
}

/// 683 times a float of few digits is a float again (2049 for 3 W/m^2). Then the digits decide:
/// hardly anybody types a multiple of 683.
bool fitsStandard(const BlenderLamp& lamp) {
    const double watts = power(lamp) / kLumensPerWatt;
    return wasFloat(watts) && (!fitsUnitless(lamp) || isRound(watts));
}

/// Raw and Unitless write suns alike.
bool fitsRaw(const BlenderLamp& lamp) {
    return wasFloat(lamp.intensity);
}

const char* unitOf(const BlenderLamp& lamp) {
    return lamp.isSun ? " W/m^2" : " W";
}

/// The names as "'a', 'b', 'c' and 4 more".
std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
        text += (i > 0 ? ", '" : "'") + printable(names[i], 60) + "'";
    }
    if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " more";
    return text;
}

/// Whether a material does not emit and has no parameters of reflection.
bool isBare(const json& material) {
    const auto surface = material.find("pbrMetallicRoughness");
    const auto emission = material.find("emissiveFactor");
    const bool emits = emission != material.end() && *emission != json::array({0, 0, 0});
    return !emits && (surface == material.end() || surface->empty());
}

}  // namespace

bool isFromBlender(const Document& document) {
    return document.model.asset.generator.find("Blender") != std::string::npos;
}

BlenderLighting lightingOf(const std::vector<BlenderLamp>& lamps) {
    std::size_t saying = 0, standard = 0, raw = 0, rawSuns = 0;
    for (const BlenderLamp& lamp : lamps) {
        saying += fitsUnitless(lamp) || fitsStandard(lamp) || fitsRaw(lamp);
        standard += fitsStandard(lamp);
        raw += fitsRaw(lamp);
        rawSuns += lamp.isSun && fitsRaw(lamp);
    }
    if (standard > 0 && standard == saying) return BlenderLighting::Standard;
    if (raw > rawSuns && raw == saying) return BlenderLighting::Raw;
    return BlenderLighting::Unitless;
}

void warnAboutLighting(const Document& document, const std::vector<Placement>& placements,
                       LampUnits units, Warnings& warnings) {
    if (!isFromBlender(document)) return;
    std::vector<BlenderLamp> lamps;
    std::vector<const tinygltf::Light*> sources;
    for (const Placement& placement : placements) {
        const tinygltf::Light* light = lightOf(document, placement.node);
        if (!light) continue;
        lamps.push_back({light->type == "directional", light->intensity});
        sources.push_back(light);
    }
    const BlenderLighting lighting = lightingOf(lamps);
    if (lighting == BlenderLighting::Unitless) return;
    const bool standard = lighting == BlenderLighting::Standard;
    if (standard && units == LampUnits::Photometric) return;

    const auto example = std::find_if(lamps.begin(), lamps.end(), [&](const BlenderLamp& lamp) {
        return standard ? fitsStandard(lamp) : !lamp.isSun && fitsRaw(lamp);
    });
    const std::string name = sources[std::size_t(example - lamps.begin())]->name;
    const double here = power(*example), there = here / (standard ? kLumensPerWatt : kSphere);
    warnings.add(std::string(standard ? "lamps are 683" : "points and spots are 4 pi") +
                     " times too bright: Blender's export had Data > Lighting on " +
                     (standard ? "Standard" : "Raw") + " ('" + printable(name, 60) + "' has " +
                     floatText(here) + unitOf(*example) + " here, in Blender " + floatText(there) +
                     "); " +
                     (standard ? "render with --units photometric, or export again with Unitless"
                               : "export again with Unitless"),
                 1);
}

void warnAboutBareMaterials(const Document& document, const SceneDescription& scene,
                            Warnings& warnings) {
    const auto materials = document.json.find("materials");
    const std::size_t count = document.model.materials.size();
    std::set<std::size_t> used;
    for (const Instance& instance : scene.instances) {
        used.insert(scene.meshes[instance.mesh].material);
    }
    std::vector<std::string> names;
    for (const std::size_t i : used) {
        if (i < count && isBare((*materials)[i])) names.push_back(scene.materials[i].name);
    }
    const bool blender = isFromBlender(document);
    warnings.add(
        "materials without base colour, metallic and roughness are rendered as white "
        "metal, glTF's default: " +
            listed(names) +
            (blender ? " (Blender exports no shaders but Principled BSDF and Emission: "
                       "use these)"
                     : ""),
        !names.empty());
    warnings.add(
        "objects without a material are rendered as white metal, glTF's default: give "
        "them one in Blender",
        blender && used.contains(count));
}

}  // namespace lacuna::gltf

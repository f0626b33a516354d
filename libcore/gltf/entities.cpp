#include "libcore/gltf/entities.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libcore/base/number_text.h"

namespace lacuna::gltf {
namespace {

/// Refuses `value` unless it lies in [least, most].
void require(const Document& document, const std::string& place, double value, double least,
             double most, const std::string& expected) {
    if (!(value >= least && value <= most)) {
        refuse(document.file, place, expected, numberText(value), "correct the value");
    }
}

void readCone(const Document& document, const std::string& place, const tinygltf::SpotLight& spot,
              PunctualLight& light) {
    constexpr double kRightAngle = std::numbers::pi / 2;
    constexpr double kRounding = 1e-6;  // for pi/2 written as float
    require(document, place + ".outerConeAngle", spot.outerConeAngle,
            std::numeric_limits<double>::min(), kRightAngle + kRounding,
            "an angle above 0 and at most pi/2");
    require(document, place + ".innerConeAngle", spot.innerConeAngle, 0.0,
            spot.outerConeAngle + kRounding, "an angle from 0 to outerConeAngle");
    light.outerConeAngle = std::min(spot.outerConeAngle, kRightAngle);
    light.innerConeAngle = std::min(spot.innerConeAngle, light.outerConeAngle);
}

}  // namespace

const tinygltf::Light* lightOf(const Document& document, std::size_t node) {
    const std::int32_t light = document.nodes[node].light;
    return light == Node::kNone ? nullptr : &document.model.lights[std::size_t(light)];
}

void addCamera(const Document& document, std::size_t node, const Affine& toWorld,
               SceneDescription& scene, Warnings& warnings) {
    const Node& source = document.nodes[node];
    if (source.camera < 0) return;
    const tinygltf::Camera& camera = document.model.cameras[std::size_t(source.camera)];
    const std::string place = "cameras[" + std::to_string(source.camera) + "]";
    if (camera.type != "perspective") {
        warnings.add("orthographic cameras are not rendered", 1, place);
        return;
    }
    if (toWorld.determinant() == 0.0) {
        warnings.add("cameras without extent (scale 0) are left out", 1, place);
        return;
    }
    CameraDescription result;
    result.name = !camera.name.empty()   ? camera.name
                  : !source.name.empty() ? source.name
                                         : "camera" + std::to_string(scene.cameras.size());
    result.toWorld = toWorld;
    result.yfov = camera.perspective.yfov;
    result.aspectRatio = camera.perspective.aspectRatio;
    require(document, place + ".perspective.yfov", result.yfov, 1e-6, std::numbers::pi - 1e-6,
            "an angle above 0 and below pi");
    require(document, place + ".perspective.aspectRatio", result.aspectRatio, 0.0, 1e4,
            "a ratio from 0 to 10000");
    scene.cameras.push_back(std::move(result));
}

void addLight(const Document& document, std::size_t node, const Affine& toWorld,
              const std::string& group, SceneDescription& scene, Warnings& warnings) {
    const tinygltf::Light* source = lightOf(document, node);
    if (!source) return;
    const std::string place =
        "lights[" + std::to_string(source - document.model.lights.data()) + "]";
    PunctualLight light;
    if (source->type == "point") {
        light.kind = PunctualLight::Kind::Point;
    } else if (source->type == "spot") {
        light.kind = PunctualLight::Kind::Spot;
        readCone(document, place + ".spot", source->spot, light);
    } else if (source->type == "directional") {
        light.kind = PunctualLight::Kind::Directional;
    } else {
        refuse(document.file, place + ".type", "point, spot or directional",
               '"' + source->type + '"');
    }

    constexpr double kMost = 1e30;  // it must be finite in float, its sums and squares in double
    require(document, place + ".intensity", source->intensity, 0.0, kMost,
            "a number from 0 to 1e30");
    Rgb color(1.0f);
    if (!source->color.empty()) {
        for (const double c : source->color) {
            require(document, place + ".color", c, 0.0, 1e6, "numbers from 0 to 1e6");
        }
        color = {float(source->color[0]), float(source->color[1]), float(source->color[2])};
    }
    const double perWatt = scene.lampUnits == LampUnits::Photometric ? kLumensPerWatt : 1.0;
    light.intensity = color * float(source->intensity / perWatt);
    warnings.add("the range of lights is ignored", source->range > 0.0, place);

    light.position = toWorld.m[3];
    const Vec3d axis = toWorld.vector({0, 0, -1});
    if (light.kind != PunctualLight::Kind::Point) {
        if (!(length(axis) > 0.0)) {
            warnings.add("lights without direction (scale 0) are left out", 1, place);
            return;
        }
        light.direction = normalize(axis);
    }
    const std::string& nodeName = document.nodes[node].name;
    light.group = !group.empty() ? group : !nodeName.empty() ? nodeName : source->name;
    for (const std::string* name : {&nodeName, &source->name}) {
        if (!name->empty()) light.names.push_back(*name);
    }
    scene.lights.push_back(light);
}

}  // namespace lacuna::gltf

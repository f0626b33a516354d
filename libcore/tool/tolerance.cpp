#include "libcore/tool/tolerance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace lacuna {
namespace {

std::string shortNumber(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", x);
    return text;
}

/// A factor of materials that weighs a layer or a lobe.
struct Weight {
    const char* name;  ///< singular; the plural has `s`
    float Material::*factor;
    TextureUse Material::*texture;  ///< texture of the factor alone; null: none
};

constexpr Weight kWeights[] = {
    {"clearcoat", &Material::clearcoat, &Material::clearcoatTexture},
    {"dielectric layer", &Material::specular, &Material::specularTexture},
    {"share of metal", &Material::metallic, nullptr},
    {"share of glass", &Material::transmission, &Material::transmissionTexture},
    {"diffuse transmission", &Material::diffuseTransmission, &Material::diffuseTransmissionTexture},
};

/// Leaves out factors up to `tolerance`. Returns "2 clearcoats of weight up to 0.0001", or nothing.
std::string leaveOut(const Weight& weight, double tolerance, std::vector<Material>& materials) {
    std::size_t count = 0;
    float largest = 0.0f;
    for (Material& m : materials) {
        float& factor = m.*weight.factor;
        if (!(factor > 0.0f && double(factor) <= tolerance)) continue;
        ++count;
        largest = std::max(largest, factor);
        factor = 0.0f;
        if (weight.texture) m.*weight.texture = {};
    }
    if (count == 0) return {};
    return std::to_string(count) + " " + weight.name + (count == 1 ? "" : "s") +
           " of weight up to " + shortNumber(double(largest));
}

using Power = std::array<double, 3>;  // by channel, W

Power operator+(const Power& a, const Power& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Power operator-(const Power& a, const Power& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Power times(const Rgb& c, double x) {
    return {double(c.r) * x, double(c.g) * x, double(c.b) * x};
}
double largestOf(const Power& p) {
    return std::max({p[0], p[1], p[2]});
}

/// A lamp, which can be left out by making it black.
struct Lamp {
    Rgb* colour;
    Power most, least;
};

double areaOf(const Mesh& mesh, const Affine& toWorld) {
    double area = 0.0;
    for (const auto& t : mesh.triangles) {
        const Vec3d a = toWorld.point(Vec3d(mesh.positions[t[0]]));
        area += 0.5 * length(cross(toWorld.point(Vec3d(mesh.positions[t[1]])) - a,
                                   toWorld.point(Vec3d(mesh.positions[t[2]])) - a));
    }
    return area;
}

std::vector<Lamp> lampsOf(SceneDescription& scene) {
    using std::numbers::pi;
    std::vector<Lamp> lamps;
    std::vector<double> area(scene.materials.size(), 0.0);
    for (const Instance& i : scene.instances) {
        const Mesh& mesh = scene.meshes[i.mesh];
        if (isBlack(scene.materials[mesh.material].emission)) continue;
        area[mesh.material] += areaOf(mesh, i.toWorld);
    }
    for (std::size_t i = 0; i < area.size(); ++i) {
        Material& m = scene.materials[i];
        if (!(area[i] > 0.0)) continue;
        const Power most = times(m.emission, area[i] * pi * (m.doubleSided ? 2.0 : 1.0));
        const bool certain = !m.emissiveTexture && m.alphaMode == Material::Alpha::Opaque;
        lamps.push_back({&m.emission, most, certain ? most : Power{}});
    }
    for (PunctualLight& l : scene.lights) {
        const auto cap = [](double angle) { return 2.0 * pi * (1.0 - std::cos(angle)); };
        if (isBlack(l.intensity) || l.kind == PunctualLight::Kind::Directional) continue;
        const bool spot = l.kind == PunctualLight::Kind::Spot;
        lamps.push_back({&l.intensity, times(l.intensity, spot ? cap(l.outerConeAngle) : 4.0 * pi),
                         times(l.intensity, spot ? cap(l.innerConeAngle) : 4.0 * pi)});
    }
    return lamps;
}

/// Leaves out the weakest lamps. Returns "1 of 3 lamps with at most 2e-07 of the others' power", or
/// nothing.
std::string leaveOutLights(double tolerance, SceneDescription& scene) {
    std::vector<Lamp> lamps = lampsOf(scene);
    std::stable_sort(lamps.begin(), lamps.end(), [](const Lamp& a, const Lamp& b) {
        return largestOf(a.most) < largestOf(b.most);
    });
    Power staying{}, out{};
    for (const Lamp& l : lamps) staying = staying + l.least;
    std::size_t count = 0;
    double share = 0.0;
    for (Lamp& l : lamps) {
        const Power nowStaying = staying - l.least, nowOut = out + l.most;
        double nowShare = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            if (nowOut[c] == 0.0) continue;
            // The remaining power may be zero, or negative by rounding.
            if (!(nowStaying[c] > 0.0)) nowShare = std::numeric_limits<double>::infinity();
            nowShare = std::max(nowShare, nowOut[c] / nowStaying[c]);
        }
        if (!(nowShare <= tolerance)) break;
        staying = nowStaying;
        out = nowOut;
        share = nowShare;
        *l.colour = Rgb{};
        ++count;
    }
    if (count == 0) return {};
    return std::to_string(count) + " of " + std::to_string(lamps.size()) + " lamps with at most " +
           shortNumber(share) + " of the others' power";
}

}  // namespace

std::vector<std::string> leaveOutWithin(double tolerance, SceneDescription& scene) {
    std::vector<std::string> lines;
    if (!(tolerance > 0.0)) return lines;
    const auto say = [&](const std::string& what) {
        if (what.empty()) return;
        lines.push_back("--tolerance " + shortNumber(tolerance) + ": left out are " + what);
    };
    for (const Weight& weight : kWeights) say(leaveOut(weight, tolerance, scene.materials));
    say(leaveOutLights(tolerance, scene));
    return lines;
}

std::vector<Effect> effectsWithin(double tolerance, SceneDescription& scene, double lensRadius,
                                  const MethodRow* method, std::vector<std::string>& warnings) {
    const std::vector<Effect> before = effectsOf(scene, lensRadius, method);
    const std::vector<std::string> lines = leaveOutWithin(tolerance, scene);
    warnings.insert(warnings.end(), lines.begin(), lines.end());
    std::vector<Effect> effects = effectsOf(scene, lensRadius, method);
    for (std::size_t i = 0; i < effects.size(); ++i) {
        if (!before[i].simulated || effects[i].simulated) continue;
        effects[i].reason =
            "within --tolerance " + shortNumber(tolerance) + " (" + before[i].reason + ")";
    }
    return effects;
}

}  // namespace lacuna

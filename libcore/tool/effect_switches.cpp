#include "libcore/tool/effect_switches.h"

#include <algorithm>

#include "libcore/base/error.h"
#include "libcore/base/text_list.h"

namespace lacuna {
namespace {

/// Adds a white texture of one texel and returns a use of it.
TextureUse addTexel(SceneDescription& scene, bool srgb) {
    Texture t;
    t.width = t.height = 1;
    t.rgba = {255, 255, 255, 255};
    t.srgb = srgb;
    scene.textures.push_back(std::move(t));
    TextureUse use;
    use.value = std::int32_t(scene.textures.size() - 1);
    return use;
}

void eraseLights(SceneDescription& scene, PunctualLight::Kind kind) {
    std::erase_if(scene.lights, [&](const PunctualLight& l) { return l.kind == kind; });
}

void makeOpaque(SceneDescription& scene, Material::Alpha mode) {
    for (Material& m : scene.materials) {
        if (m.alphaMode == mode) m.alphaMode = Material::Alpha::Opaque;
    }
}

/// Switches an effect off; `name` is any row of effectsOf().
void switchOff(const std::string& name, const SwitchTargets& to) {
    SceneDescription& scene = to.scene;
    if (name == "area_lights") {
        for (Material& m : scene.materials) m.emission = {};
    } else if (name == "point_lights") {
        eraseLights(scene, PunctualLight::Kind::Point);
    } else if (name == "spot_lights") {
        eraseLights(scene, PunctualLight::Kind::Spot);
    } else if (name == "directional_lights") {
        eraseLights(scene, PunctualLight::Kind::Directional);
    } else if (name == "environment") {
        scene.environment.reset();
    } else if (name == "emissive_textures") {
        for (Material& m : scene.materials) m.emissiveTexture = {};
    } else if (name == "textures") {
        for (Material& m : scene.materials) {
            for (const auto texture : kBsdfTextures) m.*texture = {};
        }
    } else if (name == "clearcoat") {
        for (Material& m : scene.materials) m.clearcoat = 0.0f;
    } else if (name == "specular_color") {
        for (Material& m : scene.materials) {
            m.specularColor = Rgb(1.0f);
            m.specularColorTexture = {};
        }
    } else if (name == "anisotropy") {
        for (Material& m : scene.materials) {
            m.anisotropy = 0.0f;
            m.anisotropyTexture = {};
        }
    } else if (name == "alpha_mask") {
        makeOpaque(scene, Material::Alpha::Mask);
    } else if (name == "alpha_blend") {
        makeOpaque(scene, Material::Alpha::Blend);
    } else if (name == "normal_maps") {
        for (Material& m : scene.materials) m.normalTexture = m.clearcoatNormalTexture = {};
    } else if (name == "vertex_colors") {
        for (Mesh& m : scene.meshes) m.colors = {};
    } else if (name == "attenuation") {
        for (Material& m : scene.materials) m.absorption = {};
    } else if (name == "thin_lens") {
        to.lensRadius = 0.0;
    } else if (name == "hits") {
        to.techniques->hits = false;
    } else if (name == "connections") {
        to.techniques->connects = false;
    } else if (name == "splats") {
        to.techniques->splats = false;
    } else if (name == "chains") {
        to.techniques->chains = false;
    } else if (name == "refractions") {
        to.techniques->refractions = to.techniques->knownWays = false;
    }
    for (const LobeRow& row : lobeTable()) {
        if (name != row.name) continue;
        for (Material& m : scene.materials) m.without.add(row.kind);
    }
}

/// Switches an effect on. False if the scene has nothing on which the effect's code could work.
bool switchOn(const std::string& name, const SwitchTargets& to) {
    SceneDescription& scene = to.scene;
    if (name == "textures") {
        const TextureUse white = addTexel(scene, false);
        for (Material& m : scene.materials) {
            if (!m.baseColorTexture) m.baseColorTexture = white;
            if (!m.metallicRoughnessTexture) m.metallicRoughnessTexture = white;
        }
    } else if (name == "emissive_textures") {
        const TextureUse white = addTexel(scene, false);
        for (Material& m : scene.materials) {
            if (!isBlack(m.emission) && !m.emissiveTexture) m.emissiveTexture = white;
        }
    } else if (name == "normal_maps") {
        const TextureUse flat = addTexel(scene, false);
        for (Material& m : scene.materials) {
            if (m.normalTexture) continue;
            m.normalTexture = flat;
            m.normalScale = 0.0f;
        }
    } else if (name == "alpha_mask") {
        for (Material& m : scene.materials) {
            if (m.alphaMode != Material::Alpha::Opaque) continue;
            m.alphaMode = Material::Alpha::Mask;
            m.baseAlpha = 0.75f;  // below one, so that it is tested, and above the cutoff
            m.alphaCutoff = 0.0f;
        }
    } else if (name == "attenuation") {
        constexpr float kUnseen = 1e-30f;  // exp of it rounds to 1
        for (Material& m : scene.materials) {
            if (isBlack(m.absorption)) m.absorption = Rgb(kUnseen);
        }
    } else if (name == "vertex_colors") {
        for (Mesh& m : scene.meshes) {
            if (m.colors.empty()) m.colors.assign(m.positions.size(), {1, 1, 1, 1});
        }
    } else {
        return false;
    }
    return true;
}

}  // namespace

std::vector<EffectSwitch> parseEffectSwitches(std::span<const std::string> texts) {
    std::vector<EffectSwitch> switches;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        const std::string name = text.substr(0, equals);
        const std::string value = equals == text.npos ? "" : text.substr(equals + 1);
        if (name.empty() || (value != "on" && value != "off")) {
            throw UsageError("--effect: expected NAME=on or NAME=off, found '" + text + "'");
        }
        std::erase_if(switches, [&](const EffectSwitch& s) { return s.name == name; });
        switches.push_back({name, value == "on"});
    }
    return switches;
}

std::vector<std::string> forceEffects(std::span<const EffectSwitch> switches,
                                      const SwitchTargets& targets, std::vector<Effect>& effects) {
    std::vector<std::string> warnings;
    for (const EffectSwitch& s : switches) {
        const std::string option = "--effect " + s.name;
        const auto effect = std::find_if(effects.begin(), effects.end(),
                                         [&](const Effect& e) { return e.name == s.name; });
        if (effect == effects.end()) {
            throw UsageError(option + ": expected one of " + joined(effects, ", ", &Effect::name) +
                             "; see --effects");
        }
        if (effect->simulated == s.on) continue;
        if (s.on) {
            if (!switchOn(s.name, targets)) {
                throw UsageError(option + "=on: there is nothing to simulate (" + effect->reason +
                                 "); leave it out");
            }
            effect->reason = "on by --effect (" + effect->reason + ")";
        } else {
            switchOff(s.name, targets);
            warnings.push_back(s.name + " is off though the scene calls for it (" + effect->reason +
                               "): the picture may lack what it does");
            effect->reason = "off by --effect, though " + effect->reason;
        }
        effect->simulated = s.on;
        effect->forced = true;
    }
    return warnings;
}

}  // namespace lacuna

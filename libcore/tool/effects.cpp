#include "libcore/tool/effects.h"

#include <algorithm>
#include <initializer_list>
#include <set>

namespace lacuna {
namespace {

/// The materials, textures and lights that a scene's instances really use, counted once.
struct Inventory {
    std::vector<const Material*> materials;  // used by at least one triangle
    std::size_t emissiveTriangles = 0, coloredPrimitives = 0;
    bool emissiveTextures = false;
    std::size_t points = 0, spots = 0, directionals = 0;

    explicit Inventory(const SceneDescription& scene) {
        std::set<std::uint32_t> used;
        for (const Instance& instance : scene.instances) {
            const Mesh& mesh = scene.meshes[instance.mesh];
            if (mesh.triangles.empty()) continue;
            used.insert(mesh.material);
            coloredPrimitives += !mesh.colors.empty();
            const Material& m = scene.materials[mesh.material];
            if (isBlack(m.emission)) continue;
            emissiveTriangles += mesh.triangles.size();
            emissiveTextures = emissiveTextures || bool(m.emissiveTexture);
        }
        for (const std::uint32_t i : used) materials.push_back(&scene.materials[i]);
        for (const PunctualLight& light : scene.lights) {
            if (isBlack(light.intensity)) continue;
            points += light.kind == PunctualLight::Kind::Point;
            spots += light.kind == PunctualLight::Kind::Spot;
            directionals += light.kind == PunctualLight::Kind::Directional;
        }
    }

    template <class Test>
    std::size_t count(const Test& test) const {
        return std::size_t(std::count_if(materials.begin(), materials.end(),
                                         [&](const Material* m) { return test(*m); }));
    }
};

/// Predicate of materials: whether they may have lobes of the kind that are not left out.
auto withLobes(LobeKind kind) {
    return [kind](const Material& m) {
        return lobeTable()[std::size_t(kind)].mayHave(m) && !m.without.has(kind);
    };
}

class Table {
  public:
    /// Adds a row: `found` things of the name `noun` (followed by `rest`) need the effect. If there
    /// are none, it is left out for the reason `missing`.
    void add(const char* name, std::size_t found, const std::string& noun, const std::string& rest,
             const std::string& missing) {
        const std::string text =
            std::to_string(found) + " " + noun + (found == 1 ? "" : "s") + rest;
        rows.push_back({name, found > 0, found > 0 ? text : missing});
    }
    void add(const char* name, bool simulated, const std::string& reason) {
        rows.push_back({name, simulated, reason});
    }
    std::vector<Effect> rows;
};

}  // namespace

std::vector<Effect> effectsOf(const SceneDescription& scene, double lensRadius,
                              const MethodRow* method) {
    const Inventory have(scene);
    Table t;
    t.add("area_lights", have.emissiveTriangles, "emissive triangle", "", "no emissive material");
    t.add("point_lights", have.points, "point light", "", "no point light");
    t.add("spot_lights", have.spots, "spot light", "", "no spot light");
    t.add("directional_lights", have.directionals, "directional light", "", "no directional light");
    t.add(
        "environment", scene.environment.has_value(),
        scene.environment
            ? scene.environment->colour ? "the same light from everywhere" : scene.environment->file
            : "no environment map: paths that leave the scene end, no disk sampling");
    t.add("emissive_textures", have.emissiveTextures,
          have.emissiveTextures ? "emission varies over triangles" : "no emissive texture");
    t.add("textures", have.count([](const Material& m) {
        return std::any_of(kBsdfTextures.begin(), kBsdfTextures.end(),
                           [&](TextureUse Material::*texture) { return bool(m.*texture); });
    }),
          "textured material", "", "no texture");
    t.add("alpha_mask",
          have.count([](const Material& m) { return m.alphaMode == Material::Alpha::Mask; }),
          "material", " with alphaMode MASK", "no material with alphaMode MASK: no alpha test");
    t.add("alpha_blend",
          have.count([](const Material& m) { return m.alphaMode == Material::Alpha::Blend; }),
          "material", " with alphaMode BLEND: a share of the rays passes",
          "no material with alphaMode BLEND");
    t.add("normal_maps",
          have.count([](const Material& m) { return m.normalTexture || m.clearcoatNormalTexture; }),
          "material", " with a normal map", "no normal map");
    t.add("vertex_colors", have.coloredPrimitives, "coloured primitive", "",
          "no mesh with COLOR_0");

    t.add("diffuse", have.count(withLobes(LobeKind::Diffuse)), "material", " with a diffuse lobe",
          "no diffuse material");
    t.add("diffuse_transmission", have.count(withLobes(LobeKind::DiffuseTransmission)), "material",
          " that light shines through diffusely",
          "no material that light shines through diffusely, as through leaves or paper");
    t.add("sheen", have.count(withLobes(LobeKind::Sheen)), "material", " with the sheen of cloth",
          "no sheen");
    t.add("glossy", have.count(withLobes(LobeKind::Glossy)), "material", " with a rough reflection",
          "no rough metal or coat");
    t.add("clearcoat", have.count([](const Material& m) { return m.clearcoat > 0.0f; }), "material",
          " under a clearcoat", "no clearcoat");
    t.add("specular_color", have.count([](const Material& m) {
        return mayReflect(m) && (m.specularColor != Rgb(1.0f) || m.specularColorTexture);
    }),
          "material", " with a coloured coat", "no coat with a colour of its own");
    t.add("anisotropy", have.count([](const Material& m) { return m.anisotropy > 0.0f; }),
          "brushed material", "", "no brushed material");
    t.add("mirror", have.count(withLobes(LobeKind::Mirror)), "material",
          " with a perfectly smooth reflection", "no metal or coat of roughness 0");
    const char* none = "no transmissive solid of that kind: no refraction, no eta factor";
    t.add("rough_refraction", have.count(withLobes(LobeKind::RoughRefraction)), "rough solid",
          " of glass", none);
    t.add("smooth_refraction", have.count(withLobes(LobeKind::SmoothRefraction)), "smooth solid",
          " of glass", none);
    t.add("rough_thin_transmission", have.count(withLobes(LobeKind::RoughThinTransmission)),
          "rough thin sheet", "", "no rough thin sheet");
    t.add("smooth_thin_transmission", have.count(withLobes(LobeKind::SmoothThinTransmission)),
          "smooth thin sheet", "", "no smooth thin sheet");
    t.add("attenuation", have.count([](const Material& m) { return !isBlack(m.absorption); }),
          "coloured solid", " of glass", "no solid of glass with an attenuation colour");
    t.add("thin_lens", lensRadius > 0.0,
          lensRadius > 0.0 ? "the aperture is above 0" : "the aperture is 0: a pinhole");

    if (method) {
        const std::vector<Effect> techniques = techniqueEffects(*method, scene, t.rows);
        t.rows.insert(t.rows.end(), techniques.begin(), techniques.end());
    }
    return t.rows;
}

std::vector<Effect> techniqueEffects(const MethodRow& method, const SceneDescription& scene,
                                     std::span<const Effect> ofScene) {
    const auto simulated = [&](std::initializer_list<const char*> names) {
        return std::ranges::any_of(ofScene, [&](const Effect& e) {
            return e.simulated && std::ranges::find(names, e.name) != names.end();
        });
    };
    const bool hittable = simulated({"area_lights", "environment"});
    const bool anyLight =
        hittable || simulated({"point_lights", "spot_lights", "directional_lights"});
    Table table;
    const Techniques& t = method.techniques;
    table.add("hits", t.hits && hittable,
              !t.hits    ? method.name + " has no technique s = 0"
              : hittable ? "an eye path can run into a light"
                         : "no light that an eye path can run into");
    table.add("connections", t.connects && anyLight,
              !t.connects ? method.name + " connects no vertices"
              : anyLight  ? "eye vertices are connected with light vertices"
                          : "no light");
    table.add("splats", t.splats && anyLight,
              !t.splats  ? method.name + " has no technique t = 1"
              : anyLight ? "light paths are seen by the lens"
                         : "no light");
    const bool noSize = simulated({"point_lights", "spot_lights", "directional_lights"});
    const bool specular = simulated({"mirror", "smooth_refraction", "smooth_thin_transmission"});
    table.add("chains", t.connects && t.chains && noSize && specular,
              !t.connects ? method.name + " connects no vertices"
              : !t.chains ? method.name + " merges: its photons make those paths"
              : !noSize   ? "no light without a size"
              : specular
                  ? "lights without a size, seen over up to six mirrors or surfaces of smooth "
                    "glass where nothing else joins the path; over more they are missing"
                  : "no mirror and no smooth glass");
    const bool facets = simulated({"rough_refraction", "rough_thin_transmission"}) &&
                        std::ranges::any_of(scene.materials, mayBeNarrowGlass);
    const bool glass = facets || simulated({"smooth_refraction", "smooth_thin_transmission"});
    const bool ways = t.knownWays && specular;
    const bool reaches = (hittable && (glass || ways)) || (noSize && facets);
    table.add("refractions", t.hits && t.connects && t.refractions && reaches,
              !t.connects      ? method.name + " connects no vertices"
              : !t.hits        ? method.name + " has no technique s = 0"
              : !t.refractions ? method.name + " merges: its photons make those paths"
              : facets    ? "next event through up to six surfaces of smooth or nearly smooth glass"
              : !hittable ? "no lamp with a size and no sky"
              : ways      ? "next event over up to six mirrors or surfaces of smooth glass"
              : glass     ? "next event through up to six surfaces of smooth glass"
              : specular  ? method.name + " merges: its photons make what mirrors reflect"
                          : "no mirror and no smooth glass");
    for (Effect& e : table.rows) e.ofScene = false;
    return table.rows;
}

std::string effectsText(const std::vector<Effect>& effects) {
    std::size_t width = 0;
    for (const Effect& e : effects) width = std::max(width, e.name.size());
    std::string text;
    for (const bool simulated : {true, false}) {
        for (const Effect& e : effects) {
            if (e.simulated != simulated) continue;
            std::string name = e.name;
            name.resize(width + 2, ' ');
            text += (simulated ? "simulated  " : "left_out   ") + name + e.reason + "\n";
        }
    }
    return text;
}

}  // namespace lacuna

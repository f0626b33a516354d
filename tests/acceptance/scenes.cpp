#include "tests/acceptance/scenes.h"

#include <unistd.h>

#include <filesystem>
#include <map>

#include "libcore/image/image_io.h"

namespace lacuna::test {

Mesh sphere(Vec3 centre, float radius, int segments, std::uint32_t material, bool smooth) {
    Mesh m;
    m.material = material;
    const int rows = segments / 2;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= segments; ++i) {
            const double phi = 2 * std::numbers::pi * (i % segments) / segments;
            const double theta = std::numbers::pi * j / rows;
            const Vec3 n(Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta),
                               std::sin(theta) * std::sin(phi)});
            m.positions.push_back(centre + n * radius);
            if (smooth) m.normals.push_back(n);
            m.uvs.push_back({float(i) / float(segments), float(j) / float(rows)});
        }
    }
    const auto at = [&](int j, int i) { return std::uint32_t(j * (segments + 1) + i); };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < segments; ++i) {
            if (j > 0) m.triangles.push_back({at(j, i), at(j, i + 1), at(j + 1, i)});
            if (j + 1 < rows) m.triangles.push_back({at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)});
        }
    }
    return m;
}

std::string constantSky(float radiance) {
    static std::map<float, std::string> files;
    std::string& file = files[radiance];
    if (file.empty()) {
        // One file per process: tests run side by side.
        file = std::filesystem::temp_directory_path() /
               ("lacuna-acceptance-sky-" + std::to_string(getpid()) + "-" +
                std::to_string(files.size()) + ".exr");
        LayeredImage sky(4, 2);
        sky.setRgb("", Image(4, 2, Rgb(radiance)));
        writeImage(file, sky);
        static const struct Cleaner {
            ~Cleaner() {
                for (const auto& [r, f] : files) std::filesystem::remove(f);
            }
        } cleaner;
    }
    return file;
}

std::string sunnySky() {
    return LACUNA_SCENES "/sky.hdr";
}

std::string nameOf(LightChoice light) {
    static const char* const names[] = {"quad",           "two-sided",      "sphere",      "point",
                                        "spot",           "directional",    "environment", "veiled",
                                        "veiled texture", "masked texture", "hidden"};
    return names[int(light)];
}

Texture patches() {
    Texture t;
    t.width = t.height = 4;
    for (int i = 0; i < 16; ++i) {
        const int x = std::min(i % 4, 3 - i % 4), y = std::min(i / 4, 3 - i / 4);
        const std::uint8_t texel[] = {255, 255, 255, std::uint8_t((x ^ y) ? 230 : 25)};
        t.rgba.insert(t.rgba.end(), texel, texel + 4);
    }
    return t;
}

namespace {

/// A lamp's material with alpha.
std::uint32_t alphaLamp(SceneBuilder& b, Rgb radiance, lacuna::Material::Alpha mode,
                        float baseAlpha, bool textured) {
    lacuna::Material m = emitter(radiance, false, Rgb(0.3f));
    m.alphaMode = mode;
    m.baseAlpha = baseAlpha;
    if (textured) {
        m.baseColorTexture = b.add(patches());
        m.emissiveTexture = m.baseColorTexture;
    }
    return b.add(m);
}

}  // namespace

SceneBuilder stage() {
    SceneBuilder b;
    const auto wall = b.add(matte({0.7f, 0.6f, 0.5f}));
    const auto red = b.add(matte({0.7f, 0.2f, 0.1f}));
    const auto gold = b.add(metal({0.9f, 0.7f, 0.4f}, 0.6f));
    const auto lacquer = b.add(plastic({0.2f, 0.4f, 0.7f}, 0.5f));
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    b.add(quad({-2, 0, -1.2f}, {4, 0, 0}, {0, 2.5f, 0}, wall));
    b.add(box({-1, 0, -0.6f}, {-0.5f, 0.5f, -0.1f}, red));
    b.add(sphere({0, 0.36f, -0.3f}, 0.35f, 16, gold));
    b.add(box({0.55f, 0, -0.3f}, {1, 0.6f, 0.2f}, lacquer));
    b.add(lookAt({0, 1.1, 3.2}, {0, 0.5, -0.3}, 40));
    return b;
}

void addLight(SceneBuilder& b, LightChoice light, float scale) {
    const auto emit = [&](float radiance, bool twoSided = false) {
        return b.add(emitter(Rgb(radiance * scale) * Rgb(1, 0.9f, 0.8f), twoSided));
    };
    switch (light) {
        case LightChoice::Quad:  // front down
            b.add(quad({-0.9f, 2.2f, 0}, {0.8f, 0, 0}, {0, 0, 0.6f}, emit(5)));
            break;
        case LightChoice::TwoSided:
            b.add(quad({0.5f, 1.3f, 0.1f}, {0.6f, 0, -0.3f}, {0, 0.6f, 0.1f}, emit(4, true)));
            break;
        case LightChoice::Sphere:  // out of the picture: its edge would cross a pixel by 0.4 %
            b.add(sphere({0.9f, 1.95f, 0.5f}, 0.25f, 8, emit(6)));
            break;
        case LightChoice::Point:
            b.add(pointLight({-0.4, 1.6, 0.9}, Rgb(1.5f * scale)));
            break;
        case LightChoice::Spot:
            b.add(spotLight({1.2, 2.2, 1.2}, {-0.5, -1, -0.6}, Rgb(5 * scale), 0.35, 0.6));
            break;
        case LightChoice::Directional:
            b.add(directionalLight({0.3, -1, -0.5}, Rgb(1.2f * scale)));
            break;
        case LightChoice::Environment:
            b.environment(sunnySky(), double(scale));
            break;
        // Close above the things, so that eye paths run into them and through them.
        case LightChoice::Veiled:
            b.add(quad({-1.2f, 1.1f, -0.2f}, {0.9f, 0.1f, 0}, {0, 0, 0.7f},
                       alphaLamp(b, Rgb(5 * scale), lacuna::Material::Alpha::Blend, 0.4f, false)));
            break;
        case LightChoice::VeiledTexture:
            b.add(quad(
                {0.4f, 1.2f, 0}, {0.8f, 0, 0}, {0, 0.1f, 0.6f},
                alphaLamp(b, Rgb(6, 5, 4) * scale, lacuna::Material::Alpha::Blend, 0.8f, true)));
            break;
        case LightChoice::MaskedTexture:
            b.add(quad({-0.3f, 1.4f, 0.1f}, {0.7f, 0.1f, 0}, {0, 0, 0.6f},
                       alphaLamp(b, Rgb(4, 5, 6) * scale, lacuna::Material::Alpha::Mask, 1, true)));
            break;
        case LightChoice::Hidden:
            b.add(quad({-0.9f, 1, 0}, {0.8f, 0, 0}, {0, 0, 0.6f},
                       alphaLamp(b, Rgb(5 * scale), lacuna::Material::Alpha::Mask, 0.4f, false)));
            break;
    }
}

SceneBuilder room(std::uint32_t floorMaterial, bool light) {
    SceneBuilder b;
    const auto red = b.add(matte({0.6f, 0.1f, 0.1f}));
    const auto green = b.add(matte({0.1f, 0.5f, 0.15f}));
    b.add(quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, floorMaterial));
    b.add(quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}));
    b.add(quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}));
    b.add(quad({1, -1, 1}, {-2, 0, 0}, {0, 2, 0}));
    b.add(quad({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, red));
    b.add(quad({1, -1, -1}, {0, 0, 2}, {0, 2, 0}, green));
    if (light) {
        b.add(quad({-0.4f, 0.95f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}, b.add(emitter(Rgb(3.0f)))));
    }
    b.add(lookAt({0, 0, 0.98}, {0, -0.1, 0}, 75));
    return b;
}

NamedScene diffuseBox() {
    NamedScene s{"diffuse box", room()};
    s.builder.add(box({-0.6f, -0.999f, -0.6f}, {-0.1f, -0.3f, -0.1f}));
    return s;
}

NamedScene glossyBox() {
    NamedScene s{"glossy and rough glass", room()};
    SceneBuilder& b = s.builder;
    b.add(sphere({-0.45f, -0.6f, -0.3f}, 0.35f, 16, b.add(metal({0.9f, 0.8f, 0.6f}, 0.45f))));
    b.add(sphere({0.4f, -0.5f, 0}, 0.35f, 16, b.add(glass(1.5f, 0.45f)), true));
    b.add(box({-0.2f, -0.99f, -0.8f}, {0.4f, -0.4f, -0.5f},
              b.add(plastic({0.3f, 0.5f, 0.7f}, 0.3f))));
    lacuna::Material pane = glass(1.3f, 0.5f);
    pane.thin = true;
    b.add(quad({-0.8f, -0.6f, 0.3f}, {0.5f, 0, 0}, {0, 0.9f, 0}, b.add(pane)));
    return s;
}

NamedScene deltaBox() {
    SceneBuilder b = room(4);
    b.add(plastic({0.5f, 0.3f, 0.2f}, 0));  // material 4, the floor's: a smooth coat over Lambert
    b.add(sphere({0.4f, -0.5f, 0}, 0.35f, 16, b.add(glass())));
    b.add(quad({-0.7f, -0.8f, -0.7f}, {0.9f, 0, -0.2f}, {0, 1.2f, 0}, b.add(mirror(Rgb(0.9f)))));
    b.add(quad({-0.8f, -0.6f, 0.3f}, {0.5f, 0, 0}, {0, 0.9f, 0}, b.add(pane({0.9f, 0.6f, 0.7f}))));
    return {"smooth glass, mirror, delta coat", std::move(b), true};
}

NamedScene underTheSky() {
    NamedScene s{"environment", stage()};
    addLight(s.builder, LightChoice::Environment);
    return s;
}

NamedScene punctualLights() {
    NamedScene s{"directional, point, spot", stage()};
    addLight(s.builder, LightChoice::Directional);
    addLight(s.builder, LightChoice::Point);
    addLight(s.builder, LightChoice::Spot);
    return s;
}

NamedScene instancedEmitters() {
    NamedScene s{"instanced and mirrored emitters", room(0, false)};
    SceneBuilder& b = s.builder;
    // One-sided: a mirrored node that forgot to turn the winding would shine the other way.
    const Mesh wedge = joined(quad({-0.2f, 0, -0.2f}, {0.4f, 0, 0}, {0, 0.1f, 0.4f}),
                              triangle({-0.2f, 0, -0.2f}, {0, -0.3f, 0}, {0.2f, 0, -0.2f}));
    Mesh lamp = wedge;
    lamp.material = b.add(emitter({4, 3, 2}, false, Rgb(0.3f)));
    const auto mesh = b.add(lamp, translation({-0.5, 0.5, 0}) * rotation({0, 0, 1}, 160));
    b.instance(mesh,
               translation({0.5, 0.5, 0}) * scaling({-1.2, 1, 0.8}) * rotation({0, 0, 1}, 160));
    b.instance(
        mesh, translation({0, -0.4, -0.4}) * scaling({0.5, -0.7, 0.5}) * rotation({1, 0, 0.3}, 40));
    const auto block = b.add(box({-0.15f, -0.15f, -0.15f}, {0.15f, 0.15f, 0.15f}),
                             translation({0.4, -0.8, 0.1}) * rotation({0, 1, 0}, 30));
    b.instance(block, translation({-0.4, -0.75, 0.2}) * scaling({1, -1.5, 1}));
    return s;
}

NamedScene bentNormals() {
    NamedScene s{"shading normals", room()};
    SceneBuilder& b = s.builder;
    b.add(sphere({-0.4f, -0.5f, -0.2f}, 0.4f, 8, 0, true));
    b.add(sphere({0.45f, -0.5f, 0}, 0.35f, 8, b.add(plastic(Rgb(0.6f), 0.4f)), true));
    Mesh ramp = quad({-0.9f, -0.9f, 0.5f}, {1.8f, 0, 0}, {0, 0.2f, -0.4f});
    ramp.normals = {{0.5f, 1, 0.4f}, {-0.6f, 1, 0.2f}, {0.3f, 1, -0.7f}, {0, 1, 1}};
    b.add(ramp);
    return s;
}

NamedScene colouredBodies() {
    NamedScene s{"coloured glass", room(), true};
    SceneBuilder& b = s.builder;
    const auto amber = b.add(colouredGlass({0.2f, 1, 4}, 1.5f, 0.5f));
    b.add(box({-0.8f, -0.95f, -0.7f}, {0.1f, -0.1f, 0}, amber));
    b.add(sphere({-0.35f, -0.5f, -0.35f}, 0.2f, 12, b.add(metal(Rgb(0.8f), 0.4f))));
    b.add(sphere({0.5f, -0.5f, 0}, 0.35f, 12, b.add(colouredGlass({3, 0.5f, 1}))));
    return s;
}

NamedScene lampsWithAlpha() {
    NamedScene s{"lamps with alpha", room(0, false)};
    SceneBuilder& b = s.builder;
    using Alpha = lacuna::Material::Alpha;
    const auto veil = alphaLamp(b, {4, 3, 2}, Alpha::Blend, 0.7f, true);
    const auto mesh = b.add(quad({-0.3f, 0, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}, veil),
                            translation({-0.4, 0.7, 0}));
    b.instance(mesh, translation({0.4, 0.5, 0}) * scaling({-1.2, 1, 0.8}));
    b.add(quad({-0.5f, -0.6f, -0.4f}, {0, 0.5f, 0.1f}, {0.5f, 0, 0},
               alphaLamp(b, {2, 3, 4}, Alpha::Mask, 1, true)));
    return s;
}

NamedScene behindGlass() {
    SceneBuilder b;
    b.d.materials[0] = matte({0.5f, 0.4f, 0.3f});
    b.add(quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}));
    lacuna::Material halfMirror = plastic({0.2f, 0.4f, 0.3f}, 0);
    halfMirror.metallic = 0.5f;
    b.add(quad({-2, 0, -1}, {4, 0, 0}, {0, 2, 0}, b.add(halfMirror)));
    b.add(box({-1.6f, 1, -0.6f}, {1.6f, 1.1f, 0.6f}, b.add(colouredGlass({0.8f, 0.5f, 0.4f}))));
    b.add(sphere({0, 0.5f, 0.3f}, 0.3f, 16, b.add(glass(1.2f)), true));
    // Walks through it go on by other lobes as well.
    lacuna::Material milky = glass(1.3f);
    milky.transmission = 0.6f;
    milky.baseColor = Rgb(0.7f);
    b.add(box({-1.2f, 0.2f, -0.2f}, {-0.5f, 0.4f, 0.5f}, b.add(milky)));
    b.add(box({0.5f, 0.2f, -0.2f}, {1.2f, 0.4f, 0.5f}, b.add(glass(1.3f, 0.2f))));
    b.add(quad({-0.5f, 1.8f, -0.4f}, {1, 0, 0}, {0, 0, 0.8f}, b.add(emitter({2, 3, 4}))));
    b.environment(sunnySky());
    b.add(lookAt({0.3, 1.2, 3}, {0, 0.4, 0}, 45));
    return {"behind glass", std::move(b), true};
}

SceneBuilder tilesOfPureColours(const Rgb& walls) {
    SceneBuilder b;
    b.d.materials[0] = matte(walls);
    b.add(box({-1, -1, -1}, {1, 1, 1}, 0, true));
    constexpr int kTiles = 40;
    const std::uint32_t tiles[] = {b.add(matte(Rgb(0.8f, 0, 0))), b.add(matte(Rgb(0, 0.8f, 0))),
                                   b.add(matte(Rgb(0, 0, 0.8f)))};
    for (int i = 0; i < kTiles; ++i) {
        const float width = 1.98f / kTiles, x = -0.99f + width * float(i);
        b.add(quad({x, -0.99f, 0.99f}, {width, 0, 0}, {0, 0, -1.98f}, tiles[i % 3]));
    }
    const auto lamp = b.add(emitter(Rgb(9, 9, 9)));
    b.add(quad({-0.3f, 0.7f, 0.2f}, {0.6f, 0, 0}, {0, 0, -0.4f}, lamp));  // it shines upwards
    b.add(lookAt({0, 0.5, 0.9}, {0, -0.8, -0.6}, 40));
    return b;
}

std::vector<NamedScene> weightScenes() {
    return {diffuseBox(),     glossyBox(),         deltaBox(),    underTheSky(),
            punctualLights(), instancedEmitters(), bentNormals(), colouredBodies(),
            lampsWithAlpha(), behindGlass()};
}

}  // namespace lacuna::test

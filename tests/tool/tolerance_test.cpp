// --tolerance: what is left out, that a warning says so, and that the promised bounds hold.
#include "libcore/tool/tolerance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "libcore/image/image_io.h"
#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

SceneDescription lamps(std::initializer_list<Rgb> intensities) {
    SceneDescription scene;
    scene.materials.resize(1);
    for (const Rgb& i : intensities) {
        PunctualLight l;
        l.intensity = i;
        scene.lights.push_back(l);
    }
    return scene;
}

/// How many of the punctual lights are black.
int dark(const SceneDescription& scene) {
    return int(std::count_if(scene.lights.begin(), scene.lights.end(),
                             [](const PunctualLight& l) { return isBlack(l.intensity); }));
}

/// Adds an emitting square of this side with its own material.
void addEmitter(SceneDescription& scene, float side, Rgb radiance) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.material = std::uint32_t(scene.materials.size());
    scene.materials.emplace_back().emission = radiance;
    scene.instances.push_back({std::uint32_t(scene.meshes.size()), {}});
    scene.meshes.push_back(std::move(mesh));
}

TEST(Tolerance, ZeroLeavesEverythingAsItIs) {
    SceneDescription scene = lamps({Rgb(1.0f), Rgb(1e-30f)});
    Material& m = scene.materials[0];
    m.clearcoat = m.specular = m.metallic = m.transmission = 1e-30f;
    EXPECT_TRUE(leaveOutWithin(0.0, scene).empty());
    EXPECT_EQ(dark(scene), 0);
    for (const float w : {m.clearcoat, m.specular, m.metallic, m.transmission}) EXPECT_GT(w, 0.0f);
}

TEST(Tolerance, LayersGoByTheirWeight) {
    for (float Material::*factor : {&Material::clearcoat, &Material::specular, &Material::metallic,
                                    &Material::transmission}) {
        SceneDescription scene = lamps({});
        Material& m = scene.materials[0];
        m.clearcoat = m.metallic = m.transmission = 0.0f;
        m.*factor = 1e-4f;
        EXPECT_TRUE(leaveOutWithin(0.99e-4, scene).empty());
        EXPECT_EQ(m.*factor, 1e-4f);
        const auto lines = leaveOutWithin(1.01e-4, scene);
        ASSERT_EQ(lines.size(), 1u);
        EXPECT_NE(lines[0].find("0.0001"), std::string::npos) << lines[0];
        EXPECT_EQ(m.*factor, 0.0f);
    }
}

TEST(Tolerance, TheWeakestLampsGoAndTheirSumCounts) {
    SceneDescription scene = lamps({Rgb(4e-4f), Rgb(1.0f), Rgb(5e-4f), Rgb(3e-4f)});
    const auto lines = leaveOutWithin(1e-3, scene);  // 3 + 4 of 10005, but not 5 as well
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_NE(lines[0].find("2 of 4 lamps"), std::string::npos) << lines[0];
    EXPECT_TRUE(isBlack(scene.lights[0].intensity) && isBlack(scene.lights[3].intensity));
    EXPECT_EQ(dark(scene), 2);
}

TEST(Tolerance, AChannelOfItsOwnKeepsALamp) {
    SceneDescription scene = lamps({Rgb(1.0f, 1.0f, 0.0f), Rgb(0.0f, 0.0f, 1e-6f)});
    EXPECT_TRUE(leaveOutWithin(0.1, scene).empty());
    EXPECT_EQ(dark(scene), 0);
}

TEST(Tolerance, NeverAllLamps) {
    for (const float i : {0.0f, 1e-30f, 1.0f, 1e30f}) {
        SceneDescription one = lamps({Rgb(i)}), two = lamps({Rgb(i), Rgb(i)});
        EXPECT_TRUE(leaveOutWithin(0.1, one).empty());
        EXPECT_TRUE(leaveOutWithin(0.1, two).empty());
    }
    SceneDescription bad = lamps({Rgb(1.0f), Rgb(std::numeric_limits<float>::infinity())});
    leaveOutWithin(0.1, bad);
    EXPECT_FALSE(isBlack(bad.lights[1].intensity));
}

TEST(Tolerance, PowersAreBoundedByShapeAndTexture) {
    // Squares of radiance 1 and area A emit pi A, points of intensity 1 emit 4 pi.
    SceneDescription scene = lamps({Rgb(1.0f)});
    addEmitter(scene, 0.06f, Rgb(1.0f));  // .0036 / 4 of the point's power
    SceneDescription textured = scene;
    EXPECT_TRUE(leaveOutWithin(0.8e-3, scene).empty());
    EXPECT_EQ(leaveOutWithin(1e-3, scene).size(), 1u);
    EXPECT_TRUE(isBlack(scene.materials[1].emission));

    // A textured lamp may be black, so it does not justify leaving out the other one, however large
    // it is.
    addEmitter(textured, 100.0f, Rgb(1.0f));
    textured.materials[2].emissiveTexture.value = 0;
    textured.lights.clear();
    EXPECT_TRUE(leaveOutWithin(0.1, textured).empty());

    // A spot emits at most in its outer cone, at least in its inner one.
    SceneDescription spots = lamps({Rgb(1.0f), Rgb(1.0f)});
    for (PunctualLight& l : spots.lights) l.kind = PunctualLight::Kind::Spot;
    spots.lights[0].outerConeAngle = 0.01;
    spots.lights[1].outerConeAngle = 1.0;
    EXPECT_TRUE(leaveOutWithin(0.1, spots).empty());  // an inner cone of 0 promises nothing
    spots.lights[1].innerConeAngle = 0.9;
    EXPECT_EQ(leaveOutWithin(0.1, spots).size(), 1u);
    EXPECT_EQ(dark(spots), 1);
}

/// Share of the light from `toLight` that is scattered, by quadrature over both sides.
double albedo(const Bsdf& bsdf, Vec3 toLight) {
    constexpr int kSteps = 96;
    double sum = 0.0;
    for (int i = -kSteps; i < kSteps; ++i) {
        for (int j = 0; j < 2 * kSteps; ++j) {
            const double z = (i + 0.5) / kSteps, r = std::sqrt(1.0 - z * z);
            const double phi = (j + 0.5) * std::numbers::pi / kSteps;
            const Vec3 toEye{float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
            sum += double(bsdf.evaluate(toEye, toLight).f.g) * std::fabs(z);
        }
    }
    return sum * std::numbers::pi / (kSteps * double(kSteps));
}

TEST(Tolerance, AlbedosChangeByTheWeightAtMost) {
    const float kIors[] = {1.5f};
    const AlbedoTables tables{std::span<const float>(kIors)};
    const Vec3 n{0, 0, 1};
    struct Case {
        const char* name;
        float Bsdf::Parameters::*weight;
    };
    for (const Case& c : {Case{"clearcoat", &Bsdf::Parameters::clearcoat},
                          Case{"specular", &Bsdf::Parameters::specular},
                          Case{"metallic", &Bsdf::Parameters::metallic},
                          Case{"transmission", &Bsdf::Parameters::transmission}}) {
        double largest = 0.0;
        for (const float base : {0.0f, 0.5f, 1.0f}) {
            for (const float mu : {0.05f, 0.5f, 1.0f}) {
                Bsdf::Parameters p;
                p.baseColor = Rgb(base);
                p.roughness = p.clearcoatRoughness = 0.7f;
                p.specular = 0.0f;
                const Vec3 toLight{std::sqrt(1.0f - mu * mu), 0.0f, mu};
                const double without = albedo(Bsdf(p, n, n, tables), toLight);
                constexpr float kWeight = 0.1f;
                p.*c.weight = kWeight;
                const double change = albedo(Bsdf(p, n, n, tables), toLight) - without;
                EXPECT_LE(std::fabs(change), 1.02 * double(kWeight)) << c.name << base << " " << mu;
                largest = std::max(largest, std::fabs(change));
            }
        }
        EXPECT_GT(largest, 1e-3) << c.name << ": nothing was there to leave out";
    }
}

using RenderTolerance = RenderTool;

TEST_F(RenderTolerance, IsSaidAndIsThePictureWithoutTheLayer) {
    // room.gltf with a faint clearcoat on all its materials.
    auto scene = nlohmann::json::parse(read("room.gltf"));
    ASSERT_FALSE(scene["materials"].empty());
    for (auto& m : scene["materials"]) {
        m["extensions"]["KHR_materials_clearcoat"]["clearcoatFactor"] = 1e-4;
    }
    scene["extensionsUsed"].push_back("KHR_materials_clearcoat");
    ASSERT_EQ(run(quick("bpt", "--quiet")).exitCode, 0);
    const Image without = readImage(path("out.exr"));
    write("room.gltf", scene.dump());

    ASSERT_EQ(run(quick("bpt", "--quiet --json @o.json")).exitCode, 0);
    EXPECT_NE(readImage(path("out.exr")).pixels, without.pixels);
    EXPECT_EQ(json("o.json")["tolerance"], 0.0);

    const Outcome o = run(quick("bpt", "--json @o.json --tolerance 0.001"));
    ASSERT_EQ(o.exitCode, 0) << o.err;
    EXPECT_NE(o.err.find("--tolerance 0.001: left out are"), std::string::npos) << o.err;
    EXPECT_EQ(readImage(path("out.exr")).pixels, without.pixels);
    const auto report = json("o.json");
    EXPECT_EQ(report["tolerance"], 0.001);
    EXPECT_FALSE(report["warnings"].empty());
    EXPECT_TRUE(report["effects"]["reasons"]["clearcoat"].get<std::string>().starts_with(
        "within --tolerance 0.001 ("));

    const Outcome listed = run("@room.gltf --effects --tolerance 0.001");
    ASSERT_EQ(listed.exitCode, 0) << listed.err;
    EXPECT_NE(listed.out.find("within --tolerance 0.001"), std::string::npos) << listed.out;
    EXPECT_NE(listed.err.find("left out are"), std::string::npos) << listed.err;
}

TEST_F(RenderTolerance, OutOfRangeIsRefused) {
    for (const char* wrong : {"-0.1", "0.2", "nan"}) {
        expectFailure(quick("bpt", std::string("--tolerance ") + wrong), 2, "--tolerance");
    }
}

}  // namespace
}  // namespace lacuna::test

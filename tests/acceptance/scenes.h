// The small scenes of the acceptance tests. All have one camera; sizes are of the order of 1.
#pragma once

#include <string>
#include <vector>

#include "tests/scene/scene_builder.h"

namespace lacuna::test {

/// A latitude-longitude sphere with its front outside; `smooth` adds normals.
Mesh sphere(Vec3 centre, float radius, int segments, std::uint32_t material, bool smooth = false);

/// The path of a constant environment of this radiance (made once in the temporary directory).
std::string constantSky(float radiance);
/// The repository's sky: non-uniform, with a sun of 7 degrees.
std::string sunnySky();

/// Kinds of lights. The last ones are lamps with alpha: BLEND by a factor and by a texture, MASK by
/// a texture, and by a factor that leaves nothing.
enum class LightChoice {
    Quad,
    TwoSided,
    Sphere,
    Point,
    Spot,
    Directional,
    Environment,
    Veiled,
    VeiledTexture,
    MaskedTexture,
    Hidden
};
inline constexpr int kLightChoices = 7;
/// A white texture of 4 x 4 texels whose alpha goes from 0 to 1 and back in both directions.
Texture patches();
std::string nameOf(LightChoice light);

/// An open stage of a floor and a back wall. On the floor are a Lambertian block, a rough metal
/// sphere and a plastic block. It has no light yet.
SceneBuilder stage();
/// Adds one light of that kind above the stage.
void addLight(SceneBuilder& scene, LightChoice light, float scale = 1);

struct NamedScene {
    std::string name;
    SceneBuilder builder;
    bool lensSeesDeltas = false;  ///< something is visible only through a mirror or smooth glass
};

/// A room seen from inside, with grey walls, one red and one green wall, and a quad light of side
/// 0.8 under the ceiling.
SceneBuilder room(std::uint32_t floorMaterial = 0, bool light = true);

NamedScene diffuseBox();
NamedScene glossyBox();
NamedScene deltaBox();
NamedScene underTheSky();
NamedScene punctualLights();
NamedScene instancedEmitters();
NamedScene bentNormals();
/// A room under lamps of which MASK and BLEND leave a part.
NamedScene lampsWithAlpha();
/// Rough and smooth bodies of coloured glass, one inside another, with a lamp and the camera
/// outside.
NamedScene colouredBodies();
/// A lamp and a sky behind a slab of coloured glass, and behind a ball.
NamedScene behindGlass();
/// A lamp that shines upwards over a floor of red, green and blue tiles, smaller than pixels: each tile absorbs all
/// light that another one reflects.
SceneBuilder tilesOfPureColours(const Rgb& walls);
/// All scenes above.
std::vector<NamedScene> weightScenes();

}  // namespace lacuna::test

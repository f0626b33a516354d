// The small scenes of the acceptance tests. All have one camera; sizes are of the order of 1.
#pragma once

#include <string>
#include <vector>

#include "tests/scene/scene_builder.h"

namespace lacuna::test {

/// Latitude-longitude sphere wound outwards, front outside; `smooth` gives it normals.
Mesh sphere(Vec3 centre, float radius, int segments, std::uint32_t material, bool smooth = false);

/// File of a constant environment of this radiance (made in the temporary directory, once).
std::string constantSky(float radiance);
/// The repository's sky: non-uniform, with a sun of 7 degrees.
std::string sunnySky();

/// Kinds of light of the pair matrix; behind them lamps with alpha: BLEND by a factor and by a
/// texture, MASK by a texture, and by a factor that leaves nothing.
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
/// 4 x 4 texels whose alpha goes from 0 to 1 in both directions and back, white.
Texture patches();
std::string nameOf(LightChoice light);

/// Floor, back wall, and on the floor a Lambert block, a rough metal sphere and a plastic block;
/// open to the rest. Lit by nothing yet.
SceneBuilder stage();
/// Adds one light of that kind above the stage.
void addLight(SceneBuilder& scene, LightChoice light, float scale = 1);

struct NamedScene {
    std::string name;
    SceneBuilder builder;
    bool lensSeesDeltas = false;  ///< something is seen through a mirror or smooth glass alone
};

/// Room of grey walls, one red and one green, a quad light of 0.8 under the ceiling, seen from
/// inside.
SceneBuilder room(std::uint32_t floorMaterial = 0, bool light = true);

NamedScene diffuseBox();
NamedScene glossyBox();
NamedScene deltaBox();
NamedScene underTheSky();
NamedScene punctualLights();
NamedScene instancedEmitters();
NamedScene bentNormals();
/// A room under lamps that MASK and BLEND leave a part of.
NamedScene lampsWithAlpha();
/// Rough and smooth bodies of coloured glass, one within another, a lamp and the camera outside.
NamedScene colouredBodies();
/// A lamp and a sky behind a slab of coloured glass, and behind a ball.
NamedScene behindGlass();
/// A lamp that shines upwards over a floor of red, green and blue tiles, smaller than pixels: what one of
/// them takes from light is all that the next one gives.
SceneBuilder tilesOfPureColours(const Rgb& walls);
/// All of these.
std::vector<NamedScene> weightScenes();

}  // namespace lacuna::test

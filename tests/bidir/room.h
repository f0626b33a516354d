// A closed room with a lamp that also scatters, for tests of walks.
#pragma once

#include "tests/scene/scene_builder.h"

namespace lacuna::test {

/// The camera sees the lamp in its upper half. The walls' texture has `texels` along each side.
inline std::unique_ptr<Scene> room(int texels) {
    SceneBuilder b;
    Texture checks;
    checks.width = checks.height = texels;
    for (int i = 0; i < texels * texels; ++i) {
        const auto grey = std::uint8_t(60 + (i * 37) % 180);
        checks.rgba.insert(checks.rgba.end(), {grey, 200, std::uint8_t(255 - grey), 255});
    }
    lacuna::Material walls = plastic(Rgb(0.9f), 0.4f);
    walls.baseColorTexture = b.add(checks);
    const std::uint32_t material = b.add(walls), lamp = b.add(emitter(Rgb(3.0f), true, Rgb(0.4f)));
    b.add(box({-1, -1, -1}, {1, 4, 1}, material, true));
    b.add(quad({-0.2f, 0.5f, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, lamp));
    b.d.cameras.push_back(lookAt({0.1, 0, 0.9}, {0, 0.1, 0}, 70));
    return b.build();
}

}  // namespace lacuna::test

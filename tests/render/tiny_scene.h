// A small room as .gltf text, so that the tests of lacuna-render need no file of the repository.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lacuna::test {

/// A room open towards the camera (which looks along -Z from z = 3), 2 units wide: diffuse floor
/// and walls, a block-less rough metal back wall, a perfect mirror on the right, a lamp under the
/// ceiling.
struct TinyScene {
    bool camera = true;
    bool lamp = true;
    bool pointLight = false;
    double pointIntensity = 2.0;
    std::string generator;    ///< asset.generator; empty: none
    std::string environment;  ///< file name beside the scene
    nlohmann::json lacuna;    ///< scene.extras.lacuna; null: none

    std::string text() const;
};

}  // namespace lacuna::test

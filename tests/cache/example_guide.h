// A small valid emission guide.
#pragma once

#include <memory>

#include "libcore/scene/emission_guide.h"
#include "tests/base/random_density.h"

namespace lacuna::test {

/// A guide of three lights.
inline std::shared_ptr<EmissionGuide> exampleGuide() {
    Rng rng(4, 0, StreamKind::User, 0);
    auto guide = std::make_shared<EmissionGuide>();
    guide->pmf = {0.25, 0.0, 0.75};
    guide->pointTree = {1, kNone, 0};
    for (int i = 0; i < 2; ++i) guide->points.push_back(randomDensity(rng, 2));
    guide->firstLeaf = {0, 2};
    guide->rayTree = {0, kNone, 1, 0};
    for (int i = 0; i < 2; ++i) guide->rays.push_back(randomDensity(rng, 6));
    guide->check(3);
    return guide;
}

}  // namespace lacuna::test

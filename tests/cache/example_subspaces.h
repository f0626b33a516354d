// A small valid file of subspaces.
#pragma once

#include "libcore/cache/subspace_file.h"

namespace lacuna::test {

/// The stamp of the example.
inline const CacheStamp kStamp{{{"scene", "0123abc"}, {"camera", "1 Cam"}, {"paths", "1000"}}};

/// An example with this number of light and eye subspaces.
inline SubspaceFile example(std::uint32_t light, std::uint32_t eye) {
    SubspaceFile file;
    file.stamp = kStamp;
    Subspaces& s = file.subspaces;
    s.lightCount = light;
    s.eyeCount = eye;
    s.cells = LightCells({{0, 1, 2}, {2}});
    const auto leaf = [](std::uint32_t label) {
        return DecisionTree::Node{0.0f, label << 4 | DecisionTree::kLeaf};
    };
    s.lightTree = DecisionTree({{0.5f, 1u << 4 | 3u}, leaf(3), leaf(light - 1)}, light);
    s.eyeTree = DecisionTree({{-2.5f, 1u << 4 | 8u}, leaf(0), leaf(eye - 1)}, eye);
    s.lightPaths = 2000;
    for (std::uint32_t i = 0; i < light; ++i) {
        s.q.push_back(0.25 * i);
        s.population.push_back(0.5 * i);
    }
    s.gamma.assign(std::size_t(light) * eye, 1.0f / float(light));
    file.contentHash = s.contentHash();
    return file;
}

}  // namespace lacuna::test

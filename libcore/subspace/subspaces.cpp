#include "libcore/subspace/subspaces.h"

#include <xxhash.h>

#include <cmath>
#include <cstdio>
#include <numeric>
#include <stdexcept>

namespace lacuna {

namespace {

/// Column sums differ from one by rounding only.
constexpr double kColumnTolerance = 1e-3;

void require(bool condition, const char* what) {
    if (!condition) throw std::invalid_argument(what);
}

std::uint32_t largestLabel(const DecisionTree& tree) {
    std::uint32_t largest = 0;
    for (const DecisionTree::Node& n : tree.nodes()) {
        if ((n.code & DecisionTree::kLeaf) == DecisionTree::kLeaf) {
            largest = std::max(largest, n.code >> 4);
        }
    }
    return largest;
}

}  // namespace

void Subspaces::check() const {
    require(lightCount > 0 && eyeCount > 0 && lightCount <= kMost && eyeCount <= kMost,
            "number of subspaces");
    require(cells.count() <= lightCount, "cells of the lights");
    require(largestLabel(lightTree) < lightCount, "labels of the light tree");
    require(largestLabel(eyeTree) < eyeCount, "labels of the eye tree");
    require(q.empty() || q.size() == lightCount, "number of Q");
    for (const double v : q) require(std::isfinite(v) && v >= 0.0, "values of Q");
    require(population.size() == q.size(), "number of populations");
    for (const double v : population) require(std::isfinite(v) && v >= 0.0, "populations");
    require(gamma.size() == std::size_t(lightCount) * eyeCount, "size of Gamma");
    for (std::uint32_t j = 0; j < eyeCount; ++j) {
        double sum = 0.0;
        for (const float g : column(j)) {
            require(std::isfinite(g) && g >= 0.0f, "values of Gamma");
            sum += double(g);
        }
        require(std::fabs(sum - 1.0) < kColumnTolerance, "columns of Gamma");
    }
}

std::string Subspaces::contentHash() const {
    XXH3_state_t* state = XXH3_createState();
    XXH3_128bits_reset(state);
    const auto add = [&](const void* data, std::size_t bytes) {
        XXH3_128bits_update(state, data, bytes);
    };
    const auto array = [&](const auto& values) {
        const std::uint64_t n = values.size();
        add(&n, sizeof(n));
        add(values.data(), values.size() * sizeof(values[0]));
    };
    array(cells.blocks());
    array(lightTree.nodes());
    array(eyeTree.nodes());
    add(&lightCount, sizeof(lightCount));
    add(&eyeCount, sizeof(eyeCount));
    add(&lightPaths, sizeof(lightPaths));
    array(q);
    array(population);
    array(gamma);
    const XXH128_hash_t digest = XXH3_128bits_digest(state);
    XXH3_freeState(state);
    char text[33];
    std::snprintf(text, sizeof(text), "%016llx%016llx", (unsigned long long)(digest.high64),
                  (unsigned long long)(digest.low64));
    return text;
}

double unseenQ(std::span<const double> q, std::uint64_t lightPaths) {
    const double total = std::accumulate(q.begin(), q.end(), 0.0);
    return total > 0.0 && lightPaths > 0 ? total / double(lightPaths) : 1.0;
}

}  // namespace lacuna

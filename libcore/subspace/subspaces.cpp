// (theory.md, "Subspaces")
#include "libcore/subspace/subspaces.h"

#include <cmath>
#include <numeric>
#include <stdexcept>

#include "libcore/base/content_hash.h"

namespace lacuna {

namespace {

/// Largest difference of a column's sum from one. Only rounding causes it.
constexpr double kColumnTolerance = 1e-3;

void require(bool condition, const char* what) {
    if (!condition) throw std::invalid_argument(what);
}

std::uint32_t largestLabel(const DecisionTree& tree) {
    std::uint32_t largest = 0;
    for (const DecisionTree::Node& n : tree.nodes()) {
        if (n.isLeaf()) largest = std::max(largest, n.index());
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
    ContentHash hash;
    const auto array = [&](const auto& values) {
        hash.addValue(std::uint64_t(values.size()));
        hash.addValues(std::span(values.data(), values.size()));
    };
    array(cells.blocks());
    array(lightTree.nodes());
    array(eyeTree.nodes());
    hash.addValue(lightCount);
    hash.addValue(eyeCount);
    hash.addValue(lightPaths);
    array(q);
    array(population);
    array(gamma);
    return hash.hex();
}

double unseenQ(std::span<const double> q, std::uint64_t lightPaths) {
    const double total = std::accumulate(q.begin(), q.end(), 0.0);
    return total > 0.0 && lightPaths > 0 ? total / double(lightPaths) : 1.0;
}

}  // namespace lacuna

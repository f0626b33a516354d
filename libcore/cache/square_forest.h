// Densities on the unit square in the form of section files: one after the other.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "libcore/base/square_density.h"

namespace lacuna {

struct SquareForest {
    std::vector<std::uint32_t> sizes;        ///< number of nodes, by tree
    std::vector<SquareDensity::Node> nodes;  ///< nodes of all trees
    static_assert(sizeof(SquareDensity::Node) == 8);

    void add(const SquareDensity& tree) {
        sizes.push_back(std::uint32_t(tree.nodes().size()));
        nodes.insert(nodes.end(), tree.nodes().begin(), tree.nodes().end());
    }
    /// Throws std::invalid_argument where sizes or nodes are not those of trees.
    std::vector<SquareDensity> trees() const {
        std::vector<SquareDensity> trees;
        std::span<const SquareDensity::Node> rest(nodes);
        for (const std::uint32_t size : sizes) {
            if (size > rest.size()) throw std::invalid_argument("sizes of trees");
            trees.emplace_back(std::vector(rest.begin(), rest.begin() + size));
            rest = rest.subspan(size);
        }
        if (!rest.empty()) throw std::invalid_argument("sizes of trees");
        return trees;
    }
};

}  // namespace lacuna

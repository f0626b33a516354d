#include "libcore/base/square_density.h"

#include <algorithm>
#include <stdexcept>

#include "libcore/base/below1.h"

namespace lacuna {

SquareDensity::SquareDensity(std::vector<Node> nodes) : nodes_(std::move(nodes)) {
    const auto require = [](bool good, const char* what) {
        if (!good) throw std::invalid_argument(std::string("density on the square: ") + what);
    };
    require(!nodes_.empty() && nodes_.size() < kSecondAxis, "no nodes, or too many");
    // Children come after their node and belong to one node alone. The tree therefore has no
    // cycles, and each node's level is known before the node is visited.
    std::vector<int> level(nodes_.size(), -1);
    std::vector<bool> seen(nodes_.size());
    level[0] = 0;
    std::uint32_t leaves = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const Node& n = nodes_[i];
        require(level[i] >= 0 && level[i] <= kMostLevels, "nodes that hang together");
        if (!(n.code & kInner)) {
            require(n.code < nodes_.size() && !seen[n.code], "leaves with numbers of their own");
            seen[n.code] = true;
            ++leaves;
            continue;
        }
        require(n.lower > 0.0f && n.lower < 1.0f, "probabilities between zero and one");
        const std::size_t child = n.code & ~(kInner | kSecondAxis);
        require(child > i && child + 1 < nodes_.size(), "children behind their node");
        for (const std::size_t c : {child, child + 1}) {
            require(level[c] < 0, "children of one node");
            level[c] = level[i] + 1;
        }
    }
    require(std::all_of(seen.begin(), seen.begin() + leaves, [](bool s) { return s; }),
            "leaves numbered from zero on");
    leafCount_ = leaves;
}

SquarePoint SquareDensity::warp(SquarePoint u) const {
    SquarePoint low{0.0, 0.0}, size{1.0, 1.0};
    const Node* node = nodes_.data();
    while (node->code & kInner) {
        const std::size_t axis = node->code & kSecondAxis ? 1 : 0;
        const double lower = double(node->lower);
        size[axis] *= 0.5;
        const bool upper = u[axis] >= lower;
        low[axis] += upper ? size[axis] : 0.0;
        u[axis] = upper ? (u[axis] - lower) / (1.0 - lower) : u[axis] / lower;
        // Rounding must not lead beyond this half.
        u[axis] = below1(u[axis]);
        node = nodes_.data() + (node->code & ~(kInner | kSecondAxis)) + (upper ? 1 : 0);
    }
    return {low[0] + size[0] * u[0], low[1] + size[1] * u[1]};
}

}  // namespace lacuna

// Random densities on the unit square.
#pragma once

#include <vector>

#include "libcore/base/rng.h"
#include "libcore/base/square_density.h"

namespace lacuna::test {

/// A random tree of halvings with random probabilities.
inline SquareDensity randomDensity(Rng& rng, int mostLeaves) {
    std::vector<SquareDensity::Node> nodes(1);
    std::uint32_t leaves = 0;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (int(nodes.size()) < 2 * mostLeaves - 1) {
            const auto child = std::uint32_t(nodes.size());
            const std::uint32_t axis = rng.below(2) ? SquareDensity::kSecondAxis : 0;
            nodes[n] = {0.2f + 0.6f * rng.uniform(), child | axis | SquareDensity::kInner};
            nodes.resize(nodes.size() + 2);
        } else {
            nodes[n] = {1.0f, leaves++};
        }
    }
    return SquareDensity(std::move(nodes));
}

}  // namespace lacuna::test

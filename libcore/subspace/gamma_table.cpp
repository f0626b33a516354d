// (theory.md, "spcbpt")
#include "libcore/subspace/gamma_table.h"

#include <algorithm>
#include <bit>

namespace lacuna {

namespace {

/// The upper half of a float, rounded to nearest; zero only where g is zero.
std::uint16_t upperHalf(float g) {
    if (!(g > 0.0f)) return 0;
    return std::uint16_t(std::max(1u, (std::bit_cast<std::uint32_t>(g) + 0x8000u) >> 16));
}

}  // namespace

GammaTable::GammaTable(const Subspaces& subspaces) : lightCount_(subspaces.lightCount) {
    std::vector<double> weights;
    for (std::uint32_t j = 0; j < subspaces.eyeCount; ++j) {
        const auto column = subspaces.column(j);
        weights.assign(column.begin(), column.end());
        columns_.emplace_back(weights);
    }
    for (const float g : subspaces.gamma) believed_.push_back(upperHalf(g));
}

}  // namespace lacuna

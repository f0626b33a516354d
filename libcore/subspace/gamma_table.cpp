#include "libcore/subspace/gamma_table.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace lacuna {

namespace {

/// The upper half of a float, rounded to nearest; never zero for what is not.
std::uint16_t upperHalf(float g) {
    if (!(g > 0.0f)) return 0;
    return std::uint16_t(std::max(1u, (std::bit_cast<std::uint32_t>(g) + 0x8000u) >> 16));
}

}  // namespace

GammaTable::GammaTable(const Subspaces& subspaces, std::uint32_t first, std::uint32_t end)
    : first_(first), count_(end - first) {
    const bool all = count_ == subspaces.lightCount;
    std::vector<double> weights;
    for (std::uint32_t j = 0; j < subspaces.eyeCount; ++j) {
        const auto column = subspaces.column(j).subspan(first, count_);
        weights.assign(column.begin(), column.end());
        columns_.emplace_back(weights);
        // Whole columns sum to one as they are.
        const double sum = all ? 1.0 : columns_.back().total();
        for (const float g : column) believed_.push_back(upperHalf(float(double(g) / sum)));
    }
}

double GammaTable::believed(std::uint32_t light, std::uint32_t eye) const {
    const std::uint32_t high = believed_[std::size_t(eye) * count_ + (light - first_)];
    return double(std::bit_cast<float>(high << 16));
}

}  // namespace lacuna

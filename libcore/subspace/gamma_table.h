// Gamma in tables: to draw light subspaces from, and for weights to look up. (theory.md, "spcbpt")
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "libcore/base/alias_table.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna {

class GammaTable {
  public:
    explicit GammaTable(const Subspaces& subspaces);

    /// The column of an eye subspace, to draw a light subspace from.
    const AliasTable& column(std::uint32_t eye) const { return columns_[eye]; }
    /// The probability of a light subspace that the weights believe: within 0.4 % of Gamma, and
    /// zero only where Gamma is zero.
    double believed(std::uint32_t light, std::uint32_t eye) const {
        const std::uint32_t high = believed_[std::size_t(eye) * lightCount_ + light];
        return double(std::bit_cast<float>(high << 16));
    }

  private:
    std::uint32_t lightCount_;
    std::vector<AliasTable> columns_;  // by eye subspace
    // 16 bits take half the memory. Weights look up entries for every technique of every path, at
    // random places, and any belief is unbiased.
    std::vector<std::uint16_t> believed_;
};

}  // namespace lacuna

// Gamma made ready to draw light subspaces from, and for weights to ask. (theory.md, "spcbpt")
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/base/alias_table.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna {

/// The columns of Gamma over the light subspaces [first, end): all of them, or one kind under the
/// condition that it is picked from.
class GammaTable {
  public:
    GammaTable(const Subspaces& subspaces, std::uint32_t first, std::uint32_t end);

    /// To draw from: outcomes count from `first`.
    const AliasTable& column(std::uint32_t eye) const { return columns_[eye]; }
    std::uint32_t first() const { return first_; }
    /// What the weights believe a light subspace's probability to be: within 0.4 %, never zero for
    /// what is not.
    double believed(std::uint32_t light, std::uint32_t eye) const;

  private:
    std::uint32_t first_, count_;
    std::vector<AliasTable> columns_;  // by eye subspace
    // In half the memory. Weights look it up for every technique of every path, at random, and may
    // believe what they like.
    std::vector<std::uint16_t> believed_;
};

}  // namespace lacuna

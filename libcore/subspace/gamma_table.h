// Gamma made ready to draw light subspaces from, and for weights to ask. (theory.md, "spcbpt")
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

    /// To draw a light subspace from.
    const AliasTable& column(std::uint32_t eye) const { return columns_[eye]; }
    /// What the weights believe a light subspace's probability to be: within 0.4 %, never zero for
    /// what is not.
    double believed(std::uint32_t light, std::uint32_t eye) const {
        const std::uint32_t high = believed_[std::size_t(eye) * lightCount_ + light];
        return double(std::bit_cast<float>(high << 16));
    }

  private:
    std::uint32_t lightCount_;
    std::vector<AliasTable> columns_;  // by eye subspace
    // In half the memory. Weights look it up for every technique of every path, at random, and may
    // believe what they like.
    std::vector<std::uint16_t> believed_;
};

}  // namespace lacuna

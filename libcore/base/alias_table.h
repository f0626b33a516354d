// A table that picks one of n outcomes with given weights in a single memory access.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/below1.h"

namespace lacuna {

/// Alias table [Vose91] over n outcomes. It is for tables that are too large for the processor's
/// caches or sampled very often. Elsewhere DiscreteDistribution serves, which realises its pmf
/// exactly. The pmf reported here is the nominal one: sums are in double but the stored values in
/// float, so that the realised probability differs from it by a relative error below 1e-6.
class AliasTable {
  public:
    AliasTable() = default;
    /// Weights >= 0 and finite, any dynamic range, any sum. Throws std::invalid_argument naming the
    /// first bad entry. A zero sum (or no entries) gives an empty table.
    explicit AliasTable(std::span<const double> weights);

    /// Whether no outcome can be picked: all weights are zero, or there are none.
    bool empty() const { return total_ <= 0.0; }
    std::size_t size() const { return slots_.size(); }
    /// Sum of the weights.
    double total() const { return total_; }
    /// Nominal probability of `index`.
    double pmf(std::size_t index) const { return double(slots_[index].pmf); }

    struct Pick {
        std::uint32_t index;
        double pmf;
        double remapped;  ///< u, rescaled to [0, 1) within the part that leads here; can be reused
    };
    /// Picks an outcome with u in [0, 1), never one of weight zero. Must not be called when
    /// empty().
    Pick sample(double u) const {
        const std::size_t k = slotOf(u);
        const Slot& slot = slots_[k];
        const double inside = u * double(slots_.size()) - double(k), edge = double(slot.threshold);
        // Selections, not branches: the outcome is random, so that a branch predictor would often
        // be wrong. A misprediction would be noticed only when the slot arrives from memory, and
        // all later work would be repeated.
        const bool own = inside < edge;
        const double from = own ? 0.0 : edge, width = own ? edge : 1.0 - edge;
        return {own ? std::uint32_t(k) : slot.alias, double(own ? slot.pmf : slot.aliasPmf),
                below1((inside - from) / width)};
    }
    /// Prefetches the slot that sample(u) will read. Harmless when empty().
    void prefetch(double u) const {
        __builtin_prefetch(slots_.data() + std::size_t(u * double(slots_.size())));
    }
    std::uint64_t bytes() const { return slots_.size() * sizeof(Slot); }

  private:
    struct Slot {
        float threshold = 0;  ///< fraction of the slot that belongs to its own outcome
        std::uint32_t alias = 0;
        float pmf = 0, aliasPmf = 0;
    };
    std::size_t slotOf(double u) const {
        const auto k = std::size_t(u * double(slots_.size()));
        return k < slots_.size() ? k : slots_.size() - 1;
    }

    std::vector<Slot> slots_;
    double total_ = 0.0;
};

}  // namespace lacuna

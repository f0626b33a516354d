// A table to pick one of n outcomes with given weights by a single look into memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/below1.h"

namespace lacuna {

/// Alias table [Vose91] over n outcomes, for tables that are too large for the processor's caches
/// or drawn from too often; otherwise DiscreteDistribution, which realises its pmf exactly. Here
/// the reported pmf is the nominal one: sums are in double, what is stored is float, so that the
/// realised probability is off by less than 1e-6 of it.
class AliasTable {
  public:
    AliasTable() = default;
    /// Weights >= 0 and finite, any dynamic range, any sum. Throws std::invalid_argument naming the
    /// first bad entry. A zero sum (or no entries) gives an empty table.
    explicit AliasTable(std::span<const double> weights);

    /// No outcome can be picked: all weights are zero, or there are none.
    bool empty() const { return total_ <= 0.0; }
    std::size_t size() const { return slots_.size(); }
    /// Sum of the weights.
    double total() const { return total_; }
    /// Nominal probability of `index`.
    double pmf(std::size_t index) const { return double(slots_[index].pmf); }

    struct Pick {
        std::uint32_t index;
        double pmf;
        double remapped;  ///< u, stretched to [0, 1) inside what leads here: for use again
    };
    /// u in [0, 1). Not to be called when empty(). Never an outcome of weight zero.
    Pick sample(double u) const {
        const std::size_t k = slotOf(u);
        const Slot& slot = slots_[k];
        const double inside = u * double(slots_.size()) - double(k), edge = double(slot.threshold);
        // Selections, not branches: no predictor could know them, and a wrong guess would be found
        // out when the slot arrives from memory, with all that follows to be done again.
        const bool own = inside < edge;
        const double from = own ? 0.0 : edge, width = own ? edge : 1.0 - edge;
        return {own ? std::uint32_t(k) : slot.alias, double(own ? slot.pmf : slot.aliasPmf),
                below1((inside - from) / width)};
    }
    /// Asks the cache for what sample(u) will look at. Harmless when empty().
    void prefetch(double u) const {
        __builtin_prefetch(slots_.data() + std::size_t(u * double(slots_.size())));
    }
    std::uint64_t bytes() const { return slots_.size() * sizeof(Slot); }

  private:
    struct Slot {
        float threshold = 0;  ///< of the way through the slot: below it, the slot's own outcome
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

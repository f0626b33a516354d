#include "libcore/base/alias_table.h"

#include <algorithm>

#include "libcore/base/weights.h"

namespace lacuna {

AliasTable::AliasTable(std::span<const double> weights) : slots_(weights.size()) {
    const double largest = largestWeight(weights, "alias table");
    if (largest == 0.0) return;
    // Relative to the largest weight, so that the sum neither overflows nor goes denormal.
    double sum = 0.0;
    for (const double w : weights) sum += w / largest;
    total_ = sum * largest;

    // Each outcome's share, in slots. Outcomes with more than one slot fill up the slots of those
    // with less.
    const auto n = double(weights.size());
    std::vector<double> share(weights.size());
    std::vector<std::uint32_t> small, large;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        share[i] = weights[i] / largest / sum * n;
        slots_[i].pmf = float(share[i] / n);
        (share[i] < 1.0 ? small : large).push_back(std::uint32_t(i));
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t poor = small.back(), rich = large.back();
        small.pop_back();
        slots_[poor].threshold = float(share[poor]);
        slots_[poor].alias = rich;
        share[rich] -= 1.0 - share[poor];
        if (share[rich] >= 1.0) continue;
        large.pop_back();
        small.push_back(rich);
    }
    // Each remaining outcome has one slot but for rounding. An outcome of weight zero must not get
    // its slot.
    const auto heaviest =
        std::uint32_t(std::max_element(weights.begin(), weights.end()) - weights.begin());
    for (const auto* left : {&small, &large}) {
        for (const std::uint32_t i : *left) {
            slots_[i].threshold = weights[i] > 0.0 ? 1.0f : 0.0f;
            slots_[i].alias = heaviest;
        }
    }
    for (Slot& slot : slots_) slot.aliasPmf = slots_[slot.alias].pmf;
}

}  // namespace lacuna

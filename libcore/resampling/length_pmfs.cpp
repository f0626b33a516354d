#include "libcore/resampling/length_pmfs.h"

#include <algorithm>
#include <numeric>

namespace lacuna {

void VerticesByLength::assign(const LightPool& pool, bool direct) {
    pool_ = &pool;
    takePickable(pool, direct, entries_);
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const auto& a, const auto& b) { return a.count < b.count; });
    const std::size_t longest = entries_.empty() ? 0 : entries_.back().count;
    begin_.assign(longest + 2, entries_.size());
    for (std::size_t i = entries_.size(); i-- > 0;) begin_[entries_[i].count] = i;
    // A length without vertices begins where the next one does.
    for (std::size_t s = longest + 1; s-- > 0;) begin_[s] = std::min(begin_[s], begin_[s + 1]);
}

CombinedPmf::CombinedPmf(std::span<const std::span<const double>> targets) {
    const std::size_t n = targets.empty() ? 0 : targets[0].size();
    std::vector<double> weight(n, 0.0);
    owner_.assign(n, 0);
    sum_.assign(targets.size(), 0.0);
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const double sum = sum_[t] = std::accumulate(targets[t].begin(), targets[t].end(), 0.0);
        if (!(sum > 0.0)) continue;
        for (std::size_t i = 0; i < n; ++i) {
            const double p = targets[t][i] / sum;
            if (p <= weight[i]) continue;
            weight[i] = p;
            owner_[i] = std::uint8_t(t);
        }
    }
    maxima_ = std::accumulate(weight.begin(), weight.end(), 0.0);
    std::vector<double> mass(targets.size(), 0.0);
    for (std::size_t i = 0; i < n; ++i) mass[owner_[i]] += weight[i];
    for (std::size_t i = 0; i < n; ++i) {
        if (weight[i] > 0.0) weight[i] /= mass[owner_[i]];
    }
    pmf_ = AliasTable(weight);
}

std::uint64_t bytesOf(std::span<const CombinedPmf> pmfs) {
    std::uint64_t bytes = 0;
    for (const CombinedPmf& pmf : pmfs) bytes += pmf.bytes();
    return bytes;
}

}  // namespace lacuna

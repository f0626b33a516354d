#include "libcore/resampling/cache_pmfs.h"

#include <algorithm>

namespace lacuna {

void CachePmfs::Builder::add(std::span<const WeightedVertex> row) {
    double total = 0.0;
    for (const WeightedVertex& v : row) total += v.weight;
    const std::size_t first = indices_.size();
    if (total > 0.0) {
        double sum = 0.0;
        float before = 0.0f;
        for (const WeightedVertex& v : row) {
            sum += v.weight;
            // Steps too small for floats are picks that never happen. They are not stored.
            const float now = std::min(float(sum / total), 1.0f);
            if (now <= before) continue;
            indices_.push_back(v.index);
            cdf_.push_back(before = now);
        }
        cdf_.back() = 1.0f;
    }
    sizes_.push_back(std::uint32_t(indices_.size() - first));
}

CachePmfs::CachePmfs(std::span<const Builder> builders) {
    std::size_t rows = 0, entries = 0;
    for (const Builder& b : builders) {
        rows += b.sizes_.size();
        entries += b.indices_.size();
    }
    begin_.reserve(rows + 1);
    indices_.reserve(entries);
    cdf_.reserve(entries);
    for (const Builder& b : builders) {
        for (const std::uint32_t n : b.sizes_) begin_.push_back(begin_.back() + n);
        indices_.insert(indices_.end(), b.indices_.begin(), b.indices_.end());
        cdf_.insert(cdf_.end(), b.cdf_.begin(), b.cdf_.end());
    }
}

CachePmfs::Pick CachePmfs::pick(std::uint32_t row, double u) const {
    const std::uint64_t first = begin_[row];
    const auto begin = cdf_.begin() + std::ptrdiff_t(first);
    const auto end = cdf_.begin() + std::ptrdiff_t(begin_[row + 1]);
    const auto found = std::upper_bound(
        begin, end, u, [](double value, float entry) { return value < double(entry); });
    const std::uint64_t entry = first + std::uint64_t(found - begin);
    return {indices_[entry], step(entry, first)};
}

double CachePmfs::pmf(std::uint32_t row, std::uint32_t index) const {
    const auto begin = indices_.begin() + std::ptrdiff_t(begin_[row]);
    const auto end = indices_.begin() + std::ptrdiff_t(begin_[row + 1]);
    const auto found = std::lower_bound(begin, end, index);
    if (found == end || *found != index) return 0.0;
    return step(begin_[row] + std::uint64_t(found - begin), begin_[row]);
}

std::uint64_t CachePmfs::bytes() const {
    return begin_.size() * sizeof(std::uint64_t) + indices_.size() * sizeof(std::uint32_t) +
           cdf_.size() * sizeof(float);
}

}  // namespace lacuna

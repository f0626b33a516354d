// What light vertices are worth at one cache point, and the pmfs made from that.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/method.h"

namespace lacuna {

/// What a pmf is proportional to.
enum class CacheTarget {
    Flow,        ///< mean(beta rho) G V                             [Nabata20a eq 15]
    FlowThrough  ///< mean(beta rho rho_c) G V, rho_c the cache point's BSDF  [Popov15]
};

/// A light vertex and its weight.
struct WeightedVertex {
    std::uint32_t index;
    double weight;
};

/// Takes out of `candidates` (weights without visibility) those that `visible(index)` denies.
/// Weights are tested from the largest on, until the untested rest adds up to no more than
/// `untested` of what was seen: that rest stays in unseen. 0 tests all. Keeps the order by index.
template <class Visible>
void removeHidden(std::vector<WeightedVertex>& candidates, double untested, Visible&& visible);

/// One pmf over light vertices per cache point; vertices of probability zero are not stored.
class CachePmfs {
  public:
    struct Pick {
        std::uint32_t index;
        double pmf;
    };

    /// Row after row. Weights may have any sum, zero included; indices ascend.
    class Builder {
      public:
        void add(std::span<const WeightedVertex> row);

      private:
        friend class CachePmfs;
        std::vector<std::uint32_t> sizes_, indices_;
        std::vector<float> cdf_;
    };

    CachePmfs() = default;
    /// All rows of the builders, one builder after the other.
    explicit CachePmfs(std::span<const Builder> builders);

    std::size_t rows() const { return begin_.size() - 1; }
    bool empty(std::uint32_t row) const { return begin_[row] == begin_[row + 1]; }
    /// u in [0, 1); the row must not be empty.
    Pick pick(std::uint32_t row, double u) const;
    /// Realised probability of that light vertex; zero where it is not in the row.
    double pmf(std::uint32_t row, std::uint32_t index) const;
    std::uint64_t bytes() const;

  private:
    double step(std::uint64_t entry, std::uint64_t first) const {
        return double(cdf_[entry]) - (entry == first ? 0.0 : double(cdf_[entry - 1]));
    }

    std::vector<std::uint64_t> begin_{0};
    std::vector<std::uint32_t> indices_;
    std::vector<float> cdf_;
};

template <class Visible>
void removeHidden(std::vector<WeightedVertex>& candidates, double untested, Visible&& visible) {
    const auto lighter = [](const WeightedVertex& a, const WeightedVertex& b) {
        return a.weight != b.weight ? a.weight < b.weight : a.index > b.index;
    };
    std::size_t left = candidates.size();  // [0, left) is the heap of what is not tested yet
    const auto sumOfRest = [&] {
        double sum = 0.0;
        for (std::size_t i = 0; i < left; ++i) sum += candidates[i].weight;
        return sum;
    };
    double sum = sumOfRest(), rest = sum, seen = 0.0;
    if (untested > 0.0) std::make_heap(candidates.begin(), candidates.end(), lighter);
    std::vector<WeightedVertex> kept;
    while (left > 0 && (untested <= 0.0 || rest > untested * seen)) {
        if (untested > 0.0) {
            std::pop_heap(candidates.begin(), candidates.begin() + std::ptrdiff_t(left), lighter);
        }
        const WeightedVertex v = candidates[--left];
        rest -= v.weight;
        // What is left of a difference of nearly equal numbers is their rounding.
        if (untested > 0.0 && rest < 1e-6 * sum) sum = rest = sumOfRest();
        if (!visible(v.index)) continue;
        seen += v.weight;
        kept.push_back(v);
    }
    candidates.resize(left);
    candidates.insert(candidates.end(), kept.begin(), kept.end());
    std::sort(candidates.begin(), candidates.end(),
              [](const WeightedVertex& a, const WeightedVertex& b) { return a.index < b.index; });
}

}  // namespace lacuna

// Weights of light vertices at one cache point, and the pmfs built from them. (theory.md,
// "Cache points")
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/method.h"

namespace lacuna {

/// The target that the pmf at a cache point is proportional to.
enum class CacheTarget {
    Flow,        ///< mean(beta rho) G V                             [Nabata20a eq 15]
    FlowThrough  ///< mean(beta rho rho_c) G V, rho_c the cache point's BSDF  [Popov15]
};

/// A light vertex and its weight.
struct WeightedVertex {
    std::uint32_t index;
    double weight;
};

/// One pmf over light vertices per cache point; vertices of probability zero are not stored.
class CachePmfs {
  public:
    struct Pick {
        std::uint32_t index;
        double pmf;
    };

    /// Takes pmfs row by row. The weights of a row may have any sum, zero included; its
    /// indices must ascend.
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
    /// Draws an index of the row by u in [0, 1). The row must not be empty.
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

}  // namespace lacuna

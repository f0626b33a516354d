// Union-find: which of n elements are connected.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lacuna {

class UnionFind {
  public:
    explicit UnionFind(std::size_t n) : parent_(n), sets_(n) {
        std::iota(parent_.begin(), parent_.end(), std::uint32_t(0));
    }
    /// The smallest element of the set of i.
    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// Unites the sets of a and b. False if they were one set already.
    bool join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        if (a == b) return false;
        parent_[std::max(a, b)] = std::min(a, b);
        --sets_;
        return true;
    }
    std::size_t sets() const { return sets_; }

  private:
    std::vector<std::uint32_t> parent_;
    std::size_t sets_;
};

}  // namespace lacuna

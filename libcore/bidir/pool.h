// The light vertices of an iteration that eye vertices may be connected with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/path.h"

namespace lacuna {

/// Light subpaths that a method wants of an iteration.
struct PoolRequest {
    std::uint64_t subpaths = 0;  ///< M: stored for selection; 0: no pool
};

/// The light vertices of this iteration's M subpaths. A subpath's vertices are contiguous, so the
/// prefix of any vertex is the `count` entries that end with it.
class LightPool {
  public:
    /// A vertex that a connection may end at: y_{s-1}, s = count.
    struct Entry {
        std::uint32_t vertex, count;
    };

    /// Empties the pool for `subpaths` new ones.
    void reset(std::uint64_t subpaths) {
        vertices_.clear();
        connectable_.clear();
        subpaths_ = subpaths;
    }
    /// Whole subpaths, one after the other. With maxDepth edges, y_{s-1} can be connected while
    /// s + t - 1 <= maxDepth for t = 2.
    void add(std::span<const PathVertex> vertices, int maxDepth) {
        for (const PathVertex& v : vertices) {
            if (int(v.index) <= maxDepth - 2 && v.connectable()) {
                connectable_.push_back({std::uint32_t(vertices_.size()), v.index + 1u});
            }
            vertices_.push_back(v);
        }
    }

    /// M, those without any vertex included.
    std::uint64_t subpaths() const { return subpaths_; }
    std::span<const PathVertex> vertices() const { return vertices_; }
    std::span<const Entry> connectable() const { return connectable_; }

    /// y_0 .. y_{s-1}. Asks the cache for the last vertex: it will be looked at soon, and lies
    /// anywhere in some hundred megabytes.
    Subpath prefix(Entry entry) const {
        const PathVertex* last = vertices_.data() + entry.vertex;
        prefetch(*last);
        return {last + 1 - entry.count, entry.count};
    }

  private:
    std::vector<PathVertex> vertices_;
    std::vector<Entry> connectable_;
    std::uint64_t subpaths_ = 0;
};

}  // namespace lacuna

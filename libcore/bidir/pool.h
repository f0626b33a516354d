// The light vertices of an iteration that eye vertices may be connected with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/large_pages.h"
#include "libcore/bidir/merging.h"
#include "libcore/bidir/path.h"

namespace lacuna {

/// Light subpaths that a method wants of an iteration.
struct PoolRequest {
    std::uint64_t subpaths = 0;  ///< M: stored for selection; 0: no pool
    bool perPixel = false;       ///< M is the number of the full film's pixels instead
};

/// The light vertices of this iteration's M subpaths. A subpath's vertices are contiguous, so the
/// prefix of any vertex is the `count` entries that end with it.
class LightPool {
  public:
    /// A vertex that a connection may end at: y_{s-1}, s = count.
    struct Entry {
        std::uint32_t vertex, count;
    };

    /// Empties the pool for `subpaths` new ones. It will keep the photons that a row with
    /// these merges needs.
    void reset(std::uint64_t subpaths, Merges merges = Merges::Nowhere) {
        vertices_.clear();
        connectable_.clear();
        begins_.clear();
        photons_.clear();
        subpaths_ = subpaths;
        merges_ = merges;
    }
    /// Makes room for `expected` vertices, and some more: growing would copy all of them several
    /// times over, and later iterations, which have about as many, need no new memory.
    void reserve(double expected) {
        if (expected < double(vertices_.capacity())) return;
        const auto all = std::size_t(1.1 * expected);
        vertices_.reserve(all);
        connectable_.reserve(all);
        if (merges_ != Merges::Nowhere) photons_.reserve(all);
    }
    /// Adds whole subpaths, one after the other. With maxDepth edges, y_{s-1} can be connected
    /// while s + t - 1 <= maxDepth for t = 2. `lengths` are the numbers of vertices of all
    /// subpaths, the empty ones included; only subpath() needs them.
    void add(std::span<const PathVertex> vertices, int maxDepth,
             std::span<const std::uint8_t> lengths = {}) {
        std::size_t begin = vertices_.size();
        for (const std::uint8_t length : lengths) {
            begins_.push_back(begin);
            begin += length;
        }
        for (const PathVertex& v : vertices) {
            if (merges_ != Merges::Nowhere &&
                isPhoton({&v - v.index, v.index + std::size_t(1)}, merges_)) {
                photons_.push_back(std::uint32_t(vertices_.size()));
            }
            if (int(v.index) <= maxDepth - 2 && v.connectable()) {
                connectable_.push_back({std::uint32_t(vertices_.size()), v.index + 1u});
            }
            vertices_.push_back(v);
        }
    }

    /// M, subpaths without any vertex included.
    std::uint64_t subpaths() const { return subpaths_; }
    std::span<const PathVertex> vertices() const { return vertices_; }
    std::span<const Entry> connectable() const { return connectable_; }
    /// Indices of the vertices that may be merged with.
    std::span<const std::uint32_t> photons() const { return photons_; }
    /// Whether subpath() may be called.
    bool findsSubpaths() const { return !begins_.empty(); }
    /// The subpath that was added as number `number`.
    Subpath subpath(std::size_t number) const {
        const std::size_t begin = begins_[number];
        const std::size_t end =
            number + 1 < begins_.size() ? begins_[number + 1] : vertices_.size();
        return {vertices_.data() + begin, end - begin};
    }
    /// The subpath from y_0 to vertices()[vertex].
    Subpath prefixOf(std::uint32_t vertex) const {
        const PathVertex* last = vertices_.data() + vertex;
        return {last - last->index, last->index + std::size_t(1)};
    }

    /// y_0 .. y_{s-1}. Prefetches the last vertex, which will be read soon and lies anywhere in
    /// some hundred megabytes.
    Subpath prefix(Entry entry) const {
        const PathVertex* last = vertices_.data() + entry.vertex;
        prefetch(*last);
        return {last + 1 - entry.count, entry.count};
    }

  private:
    std::vector<PathVertex, LargePages<PathVertex>> vertices_;
    std::vector<Entry> connectable_;
    std::vector<std::size_t> begins_;  // of subpaths in vertices_, where lengths were given
    std::vector<std::uint32_t> photons_;
    std::uint64_t subpaths_ = 0;
    Merges merges_ = Merges::Nowhere;
};

}  // namespace lacuna

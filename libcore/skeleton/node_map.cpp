// (theory.md, "Nodes")
#include "libcore/skeleton/node_map.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/voxel/voxelize.h"

namespace lacuna {

namespace {

/// Length of a move along one, two, three axes, in units of 2^-18 voxels.
constexpr std::uint64_t kMove[4] = {0, 262144, 370728, 454047};
constexpr std::uint64_t kUnit = kMove[1];
constexpr std::uint64_t kFar = std::numeric_limits<std::uint64_t>::max();
constexpr std::size_t kPerTask = 4096;

/// Distance and node in one number: the smaller number has the smaller distance or, in a tie, the
/// lower node.
constexpr std::uint64_t keyOf(std::uint64_t distance, std::uint64_t node) {
    return distance << 16 | node;
}

/// The 26 moves from a voxel to its neighbours.
class Moves {
  public:
    explicit Moves(const VoxelShape& shape) : shape_(shape) {
        for (int n = 0; n < 27; ++n) {
            if (n == 13) continue;
            const VoxelIndex d{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
            const int axes = std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]);
            const auto x = std::ptrdiff_t(shape.size[0]), y = std::ptrdiff_t(shape.size[1]);
            moves_[count_++] = {d, (d[2] * y + d[1]) * x + d[0], keyOf(kMove[axes], 0)};
        }
    }

    /// Calls body(voxel, key of the move) for the neighbours inside the grid.
    template <class Body>
    void from(std::size_t voxel, const Body& body) const {
        const VoxelIndex v = shape_.indexOf(voxel);
        const bool inner = v[0] > 0 && v[1] > 0 && v[2] > 0 && v[0] + 1 < shape_.size[0] &&
                           v[1] + 1 < shape_.size[1] && v[2] + 1 < shape_.size[2];
        for (const Move& m : moves_) {
            if (!inner && !shape_.contains({v[0] + m.by[0], v[1] + m.by[1], v[2] + m.by[2]})) {
                continue;
            }
            body(voxel + std::size_t(m.offset), m.key);
        }
    }

  private:
    struct Move {
        VoxelIndex by;
        std::ptrdiff_t offset;
        std::uint64_t key;
    };
    VoxelShape shape_;
    std::array<Move, 26> moves_;
    std::size_t count_ = 0;
};

/// Spreads distances in waves as wide as the shortest move. A wave never changes its own voxels, so
/// that these can be visited in any order and in parallel.
class Waves {
  public:
    Waves(const VoxelSpace& space, const ThreadPool& pool)
        : space_(space),
          pool_(pool),
          moves_(space.shape),
          key_(space.state.size(), kFar),
          done_(key_.size(), 0) {}

    void seed(std::size_t voxel, std::size_t node) {
        if (keyOf(0, node) < key_[voxel]) {
            key_[voxel] = keyOf(0, node);
            wave_[0].push_back(voxel);
        }
    }

    std::vector<std::uint64_t> run(const std::atomic<bool>& cancel) {
        for (std::size_t n = 0; !wave_[0].empty() || !wave_[1].empty() || !wave_[2].empty(); ++n) {
            throwIfCancelled(cancel);
            spread(n);
        }
        return std::move(key_);
    }

  private:
    void spread(std::size_t number) {
        const std::vector<std::size_t> wave = std::exchange(wave_[number % 3], {});
        struct Found {
            std::vector<std::size_t> next[3];
        };
        std::vector<Found> found((wave.size() + kPerTask - 1) / kPerTask);
        pool_.forEach(found.size(), [&](std::size_t task) {
            const std::size_t end = std::min(wave.size(), (task + 1) * kPerTask);
            for (std::size_t i = task * kPerTask; i < end; ++i) {
                if (std::atomic_ref(done_[wave[i]]).exchange(1, std::memory_order_relaxed))
                    continue;
                const std::uint64_t own = key_[wave[i]];
                moves_.from(wave[i], [&](std::size_t u, std::uint64_t move) {
                    if (space_.state[u] != VoxelState::Empty || !lower(u, own + move)) return;
                    const std::uint64_t distance = (own + move) >> 16;
                    found[task].next[distance / kUnit % 3].push_back(u);
                });
            }
        });
        for (const Found& f : found) {
            for (std::size_t w = 0; w < 3; ++w) {
                wave_[w].insert(wave_[w].end(), f.next[w].begin(), f.next[w].end());
            }
        }
    }

    bool lower(std::size_t voxel, std::uint64_t key) {
        const std::atomic_ref<std::uint64_t> at(key_[voxel]);
        std::uint64_t old = at.load(std::memory_order_relaxed);
        while (key < old) {
            if (at.compare_exchange_weak(old, key, std::memory_order_relaxed)) return true;
        }
        return false;
    }

    const VoxelSpace& space_;
    const ThreadPool& pool_;
    Moves moves_;
    std::vector<std::uint64_t> key_;
    std::vector<std::uint8_t> done_;
    std::vector<std::size_t> wave_[3];  // by distance / kUnit modulo 3
};

}  // namespace

std::uint16_t NodeMap::entry(const Vec3d& place) const {
    const VoxelIndex& size = shape_.size;
    const bool inside = place.x >= 0.0 && place.y >= 0.0 && place.z >= 0.0 && place.x < size[0] &&
                        place.y < size[1] && place.z < size[2];
    return inside ? entries_[shape_.at({int(place.x), int(place.y), int(place.z)})] : kNone;
}

std::uint16_t NodeMap::firstAlong(const Vec3d& place, const Vec3d& side,
                                  std::initializer_list<double> steps) const {
    for (const double step : steps) {
        const std::uint16_t e = entry(place + side * step);
        if (e < kNone) return e;
    }
    return kNone;
}

std::uint16_t NodeMap::around(const Vec3d& place, const Vec3d& side) const {
    const double steepest = std::max({std::fabs(side.x), std::fabs(side.y), std::fabs(side.z)});
    VoxelIndex low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        const int last = shape_.size[a] - 1;
        const int own = int(std::clamp(std::floor(place[a]), -2.0, last + 2.0));
        low[a] = std::max(side[a] == steepest ? own : own - 1, 0);
        high[a] = std::min(side[a] == -steepest ? own : own + 1, last);
    }
    std::uint16_t best = kNone;
    double ahead = 0.0, distance2 = 1.0;  // of the best; their ratio: 1 / the ball's diameter
    for (int z = low[2]; z <= high[2]; ++z) {
        for (int y = low[1]; y <= high[1]; ++y) {
            const std::uint16_t* row = &entries_[shape_.at({0, y, z})];
            for (int x = low[0]; x <= high[0]; ++x) {
                if (row[x] >= kNone) continue;
                const Vec3d centre = Vec3d{x + 0.5, y + 0.5, z + 0.5} - place;
                const double a = dot(centre, side), d2 = lengthSquared(centre);
                if (a * distance2 <= ahead * d2) continue;
                best = row[x];
                ahead = a;
                distance2 = d2;
            }
        }
    }
    return best;
}

std::uint16_t NodeMap::at(const Vec3d& point, const Vec3d& side) const {
    if (entries_.empty()) return kNone;
    const Vec3d place = (point - shape_.origin) / shape_.voxel;
    std::uint16_t node = firstAlong(place, side, {0.0, 0.5, 1.0});
    if (node == kNone) node = around(place, side);
    if (node == kNone) node = firstAlong(place, side, {1.5, 2.0, 2.5, 3.0});
    return node != kNone ? node : std::uint16_t(entry(place) & ~kSolid);
}

NodeMap mapNodes(const VoxelSpace& space, std::span<const SkeletonNode> nodes,
                 const ThreadPool& pool, const std::atomic<bool>& cancel) {
    if (nodes.size() >= NodeMap::kNone) {
        throw RunError("node map: expected fewer than " + std::to_string(NodeMap::kNone) +
                       " nodes, found " + std::to_string(nodes.size()) +
                       "; use a lower resolution");
    }
    const VoxelShape& shape = space.shape;
    Waves waves(space, pool);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Vec3d place = (nodes[n].position - shape.origin) / shape.voxel;
        const VoxelIndex corner{int(std::lround(place.x)), int(std::lround(place.y)),
                                int(std::lround(place.z))};
        for (int i = 0; i < 8; ++i) {
            const VoxelIndex v{corner[0] - (i & 1), corner[1] - (i >> 1 & 1), corner[2] - (i >> 2)};
            if (space.empty(v)) waves.seed(shape.at(v), n);
        }
    }
    const std::vector<std::uint64_t> key = waves.run(cancel);

    const Moves moves(shape);
    std::vector<std::uint16_t> entries(shape.count(), NodeMap::kNone);
    const auto layer = std::size_t(shape.size[0]) * std::size_t(shape.size[1]);
    pool.forEach(std::size_t(shape.size[2]), [&](std::size_t z) {
        for (std::size_t i = z * layer; i < (z + 1) * layer; ++i) {
            if (space.state[i] == VoxelState::Empty) {
                if (key[i] != kFar) entries[i] = std::uint16_t(key[i] & 0xffff);
                continue;
            }
            std::uint64_t best = kFar;
            moves.from(i, [&](std::size_t u, std::uint64_t move) {
                if (space.state[u] == VoxelState::Empty && key[u] != kFar) {
                    best = std::min(best, key[u] + move);
                }
            });
            entries[i] = std::uint16_t(
                NodeMap::kSolid | (best == kFar ? NodeMap::kNone : std::uint16_t(best & 0xffff)));
        }
    });
    return {shape, std::move(entries)};
}

std::string Skeleton::contentHash() const {
    ContentHash hash;
    const auto add = [&](const auto& value) { hash.addValue(value); };
    const auto addPoint = [&](const Vec3d& p) {
        add(p.x);
        add(p.y);
        add(p.z);
    };
    for (const SkeletonNode& n : nodes) {
        addPoint(n.position);
        add(n.radius);
    }
    for (const FilteredEdge& e : edges) {
        add(e.nodes);
        addPoint(e.leave);
        addPoint(e.enter);
    }
    add(map.shape().size);
    addPoint(map.shape().origin);
    add(map.shape().voxel);
    hash.addValues(map.entries());
    return hash.hex();
}

}  // namespace lacuna

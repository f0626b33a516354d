#include "libcore/skeleton/thinning.h"

#include <algorithm>
#include <unordered_map>

#include "libcore/base/parallel.h"
#include "libcore/voxel/components.h"
#include "libcore/voxel/voxelize.h"

namespace lacuna {

namespace {

using Corner = CubicalComplex::Corner;
constexpr std::size_t kPerTask = 4096;

struct Pair {
    Corner cell, face;
    CellAxes cellAxes, faceAxes;
};

class Thinning {
  public:
    Thinning(const VoxelSpace& space, const ThreadPool& pool, const std::atomic<bool>& cancel)
        : space_(space), pool_(pool), cancel_(cancel), result_{CubicalComplex(space)} {
        for (std::size_t n = 0; n < 27; ++n) {
            // Differences wrap around, as sums with them do.
            neighbour_[n] = n % 3 + complex().step(1) * (n / 3 % 3) + complex().step(2) * (n / 9) -
                            complex().step(0) - complex().step(1) - complex().step(2);
        }
        const std::vector<std::uint16_t> opening = openingMap(space, pool);
        layer_.assign(complex().corners(), 0);
        opening_.assign(complex().corners(), 0);
        stamp_.assign(complex().corners(), 0);
        for (std::size_t i = 0; i < space.state.size(); ++i) {
            if (space.state[i] != VoxelState::Empty) continue;
            const Corner c = complex().corner(space.shape.indexOf(i));
            layer_[c] = std::uint16_t(
                std::clamp(std::ceil(double(space.distance[i]) / space.shape.voxel), 1.0, 60000.0));
            opening_[c] = opening[i];
            lastLayer_ = std::max<std::size_t>(lastLayer_, layer_[c]);
        }
        waiting_.resize(lastLayer_ + 1);
        // Free pairs lie at or next to corners that some cube is missing at.
        std::vector<Corner> border;
        for (Corner c = 0; c < layer_.size(); ++c) {
            if (complex().cells(c) != 0 && !surrounded(c)) border.push_back(c);
        }
        activate(border, Reach::Neighbours, 1);
    }

    Thinned run() {
        collapse();
        // A puncture opens one sheet; what lay inside it may be one again.
        while (puncture() > 0) collapse();
        result_.squares = complex().count(2);
        return std::move(result_);
    }

  private:
    CubicalComplex& complex() { return result_.complex; }
    const CubicalComplex& complex() const { return result_.complex; }

    bool surrounded(Corner c) const {
        for (unsigned back = 0; back < 8; ++back) {
            Corner cube = c;
            for (int a = 0; a < 3; ++a) cube -= back >> a & 1u ? complex().step(a) : 0;
            if (layer_[cube] == 0) return false;
        }
        return true;
    }

    /// Rounds until nothing changes and all layers had their turn.
    void collapse() {
        for (;;) {
            throwIfCancelled(cancel_);
            const std::size_t round = ++result_.rounds;
            if (round <= lastLayer_) {
                activate(waiting_[round], Reach::Itself, round);
                waiting_[round] = {};
            }
            changed_.clear();
            for (int axis = 0; axis < 3; ++axis) {
                for (const bool high : {false, true}) {
                    for (int dimension = 3; dimension >= 1; --dimension) {
                        step(axis, high, dimension);
                    }
                }
            }
            active_.clear();
            activate(changed_, Reach::Neighbours, round + 1);
            rememberBirths(round);
            if (changed_.empty() && round >= lastLayer_) return;
        }
    }

    enum class Reach { Itself, Neighbours };
    /// The corners, and their 26 neighbours where asked for, join that round's list, each once.
    void activate(const std::vector<Corner>& centres, Reach reach, std::size_t round) {
        const auto mark = std::uint16_t(round % 65535 + 1);
        std::vector<std::vector<Corner>> parts((centres.size() + kPerTask - 1) / kPerTask);
        pool_.forEach(parts.size(), [&](std::size_t task) {
            const std::size_t end = std::min(centres.size(), (task + 1) * kPerTask);
            for (std::size_t i = task * kPerTask; i < end; ++i) {
                const bool alone = reach == Reach::Itself;
                for (int n = alone ? 13 : 0; n < (alone ? 14 : 27); ++n) {
                    const Corner c = centres[i] + neighbour_[std::size_t(n)];
                    const std::atomic_ref stamp(stamp_[c]);
                    // Most are in the list already: a look is cheaper than an exchange.
                    if (stamp.load(std::memory_order_relaxed) == mark || complex().cells(c) == 0) {
                        continue;
                    }
                    if (stamp.exchange(mark, std::memory_order_relaxed) != mark) {
                        parts[task].push_back(c);
                    }
                }
            }
        });
        for (const auto& p : parts) active_.insert(active_.end(), p.begin(), p.end());
    }

    /// Removes all pairs that are free in this direction and dimension. Finding and removing are
    /// two loops: what one removal frees waits for the next round.
    void step(int axis, bool high, int dimension) {
        struct Found {
            std::vector<Pair> pairs;
            std::vector<std::pair<std::size_t, Corner>> waiting;  // for that round
        };
        std::vector<CellAxes> kinds;
        unsigned mask = 0;
        for (CellAxes axes = 1; axes < 8; ++axes) {
            if (std::popcount(axes) != dimension || !(axes >> axis & 1u)) continue;
            kinds.push_back(axes);
            mask |= 1u << axes;
        }
        std::vector<Found> found((active_.size() + kPerTask - 1) / kPerTask);
        pool_.forEach(found.size(), [&](std::size_t task) {
            const std::size_t end = std::min(active_.size(), (task + 1) * kPerTask);
            for (std::size_t i = task * kPerTask; i < end; ++i) {
                const Corner c = active_[i];
                if (!(complex().cells(c) & mask)) continue;
                for (const CellAxes axes : kinds) {
                    const Pair pair{c, high ? c + complex().step(axis) : c, axes,
                                    axes & ~(1u << axis)};
                    if (!complex().has(c, axes) ||
                        complex().cofaces(pair.face, pair.faceAxes) != 1) {
                        continue;
                    }
                    const std::size_t layer = complex().largestAround(c, axes, layer_);
                    if (layer > result_.rounds) {
                        found[task].waiting.push_back({layer, c});
                    } else if (!isEnd(pair)) {
                        found[task].pairs.push_back(pair);
                    }
                }
            }
        });
        pool_.forEach(found.size(), [&](std::size_t task) {
            for (const Pair& p : found[task].pairs) {
                complex().remove(p.cell, p.cellAxes);
                complex().remove(p.face, p.faceAxes);
            }
        });
        for (const Found& f : found) {
            for (const Pair& p : f.pairs) changed_.push_back(p.cell);
            for (const auto& [layer, c] : f.waiting) waiting_[layer].push_back(c);
        }
    }

    /// Whether the free pair is an edge that has lived long enough to be the end of a branch.
    bool isEnd(const Pair& p) const {
        if (std::popcount(p.cellAxes) > 1) return false;
        const auto birth = birth_.find(edgeKey(p.cell, p.cellAxes));
        if (birth == birth_.end()) return false;
        return result_.rounds - birth->second >
               complex().largestAround(p.cell, p.cellAxes, opening_);
    }

    static std::uint64_t edgeKey(Corner c, CellAxes axes) { return std::uint64_t(c) * 8 + axes; }

    void rememberBirths(std::size_t round) {
        for (const Corner c : active_) {
            for (const CellAxes axes : {1u, 2u, 4u}) {
                if (complex().has(c, axes) && complex().cofaces(c, axes) == 0) {
                    birth_.try_emplace(edgeKey(c, axes), round);
                }
            }
        }
    }

    /// Takes one square out of every sheet about a cavity. The regions are those of the complement
    /// of the complex: cubes that are not there, joined through squares that are not there.
    std::size_t puncture() {
        std::vector<Pair> squares;
        for (Corner c = 0; c < complex().corners(); ++c) {
            for (const CellAxes axes : {3u, 5u, 6u}) {
                if (complex().has(c, axes)) squares.push_back({c, c, axes, axes});
            }
        }
        if (squares.empty()) return 0;
        const auto place = [&](const Pair& p) {
            return std::pair(complex().largestAround(p.cell, p.cellAxes, layer_),
                             edgeKey(p.cell, p.cellAxes));
        };
        std::sort(squares.begin(), squares.end(),
                  [&](const Pair& a, const Pair& b) { return place(a) < place(b); });

        const std::size_t n = complex().corners();
        std::vector<std::uint32_t> parent(n);
        for (std::size_t i = 0; i < n; ++i) parent[i] = std::uint32_t(i);
        const auto find = [&](std::size_t i) {
            while (parent[i] != i) i = parent[i] = parent[parent[i]];
            return i;
        };
        const auto normalOf = [](CellAxes axes) { return axes == 6 ? 0 : axes == 5 ? 1 : 2; };
        for (Corner c = complex().step(2); c < n; ++c) {
            for (const CellAxes axes : {3u, 5u, 6u}) {
                if (complex().has(c, axes)) continue;
                const std::size_t a = find(c), b = find(c - complex().step(normalOf(axes)));
                parent[std::max(a, b)] = std::uint32_t(std::min(a, b));
            }
        }
        std::vector<Corner> opened;
        for (const Pair& p : squares) {
            const std::size_t a = find(p.cell);
            const std::size_t b = find(p.cell - complex().step(normalOf(p.cellAxes)));
            if (a == b) continue;
            parent[std::max(a, b)] = std::uint32_t(std::min(a, b));
            complex().remove(p.cell, p.cellAxes);
            opened.push_back(p.cell);
        }
        result_.punctures += opened.size();
        activate(opened, Reach::Neighbours, result_.rounds + 1);
        return opened.size();
    }

    const VoxelSpace& space_;
    const ThreadPool& pool_;
    const std::atomic<bool>& cancel_;
    Thinned result_;
    std::array<std::size_t, 27> neighbour_;  // what to add to a corner
    // By corner, of the cube there.
    std::vector<std::uint16_t> layer_;  // round from which on it may go
    std::vector<std::uint16_t> opening_;
    std::vector<std::uint16_t> stamp_;          // by corner: last round whose list it joined
    std::vector<std::vector<Corner>> waiting_;  // by round: free pairs whose layer comes then
    std::size_t lastLayer_ = 0;
    std::vector<Corner> active_, changed_;
    std::unordered_map<std::uint64_t, std::size_t> birth_;  // round in which an edge was left alone
};

}  // namespace

Thinned thin(const VoxelSpace& space, const ThreadPool& pool, const std::atomic<bool>& cancel) {
    return Thinning(space, pool, cancel).run();
}

}  // namespace lacuna

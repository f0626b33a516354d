#include "libcore/skeleton/thinning.h"

#include <algorithm>
#include <array>
#include <compare>
#include <unordered_map>

#include "libcore/base/parallel.h"
#include "libcore/voxel/components.h"
#include "libcore/voxel/voxelize.h"

namespace lacuna {

namespace {

using Corner = CubicalComplex::Corner;
using Word = CubicalComplex::Word;
using Shift = CubicalComplex::Shift;
constexpr std::size_t kPerTask = 512;
constexpr std::size_t kAhead = 8;  // words

/// A subset of the corners of one word.
struct Some {
    std::size_t word;
    Word corners;
};

/// Calls body(corner) for each of them.
template <class Body>
void forEachCorner(Some some, const Body& body) {
    for (Word left = some.corners; left != 0; left &= left - 1) {
        body(some.word * 64 + std::size_t(std::countr_zero(left)));
    }
}

/// The pairs and waiting corners that one task of a step finds.
struct Found {
    struct Pairs {
        Some some;
        CellAxes axes;  // of the larger cell
    };
    std::vector<Pairs> pairs;                             // to be removed
    std::vector<std::pair<std::size_t, Corner>> waiting;  // corners, by the round they wait for
};

class Thinning {
  public:
    Thinning(const VoxelSpace& space, const ThreadPool& pool, const std::atomic<bool>& cancel)
        : pool_(pool), cancel_(cancel), result_{CubicalComplex(space)} {
        layer_.assign(complex().corners(), 0);
        opening_.assign(complex().corners(), 0);
        const std::vector<std::uint16_t> opening = openingMap(space, pool);
        for (std::size_t i = 0; i < space.state.size(); ++i) {
            if (space.state[i] != VoxelState::Empty) continue;
            const Corner c = complex().corner(space.shape.indexOf(i));
            layer_[c] = std::uint16_t(
                std::clamp(std::ceil(double(space.distance[i]) / space.shape.voxel), 1.0, 60000.0));
            opening_[c] = opening[i];
            lastLayer_ = std::max<std::size_t>(lastLayer_, layer_[c]);
        }
        const std::size_t words = complex().words();
        active_.assign(words, 0);
        allowed_.assign(words, 0);
        for (auto& w : recorded_) w.assign(words, 0);
        for (auto& w : born_) w.assign(words, 0);
        waiting_.resize(lastLayer_ + 1);
        opens_.resize(lastLayer_ + 1);
        for (Corner c = 0; c < layer_.size(); ++c) {
            std::vector<std::size_t>& opens = opens_[layer_[c]];
            if (opens.empty() || opens.back() != c / 64) opens.push_back(c / 64);
        }
        allow(0);  // where there is no cube, none forbids a removal
        activateBorder();
    }

    Thinned run() {
        collapse();
        // A puncture opens one sheet; there may be another one inside it.
        while (puncture() > 0) collapse();
        result_.squares = complex().count(2);
        return std::move(result_);
    }

  private:
    CubicalComplex& complex() { return result_.complex; }
    const CubicalComplex& complex() const { return result_.complex; }

    /// Activates the corners at which a cube is missing, and their neighbours: all free pairs lie
    /// there.
    void activateBorder() {
        std::vector<Some> border;
        for (std::size_t w = 0; w < complex().words(); ++w) {
            const Word points = complex().word(w, 0);
            if (points == 0) continue;
            Word surrounded = ~Word(0);
            for (unsigned back = 0; back < 8; ++back) {
                surrounded &= complex().word(w, 7, backwards(back));
            }
            if (points & ~surrounded) border.push_back({w, points & ~surrounded});
        }
        activateAround(border);
    }

    /// The displacement by -1 along each of the axes.
    Shift backwards(CellAxes axes) const {
        Shift shift;
        for (int a = 0; a < 3; ++a) {
            if (axes >> a & 1u) shift = shift + complex().shift(a, -1);
        }
        return shift;
    }

    /// Allows the removal of the cubes of that layer from now on.
    void allow(std::size_t layer) {
        for (const std::size_t w : opens_[layer]) {
            for (std::size_t b = 0; b < 64; ++b) {
                allowed_[w] |= Word(layer_[w * 64 + b] == layer) << b;
            }
        }
        opens_[layer] = {};
    }

    /// Runs rounds until nothing changes and all layers have had their turn.
    void collapse() {
        for (;;) {
            throwIfCancelled(cancel_);
            const std::size_t round = ++result_.rounds;
            if (round <= lastLayer_) {
                allow(round);
                for (const Corner c : waiting_[round]) {
                    if (complex().has(c, 0)) activate({c / 64, Word(1) << c % 64}, activeWords_);
                }
                waiting_[round] = {};
            }
            changed_.assign(activeWords_.size(), 0);
            for (int axis = 0; axis < 3; ++axis) {
                for (const bool high : {false, true}) {
                    for (int dimension = 3; dimension >= 1; --dimension) {
                        step(axis, high, dimension);
                    }
                }
            }
            std::vector<Some> changed;
            for (std::size_t i = 0; i < activeWords_.size(); ++i) {
                active_[activeWords_[i]] = 0;
                if (changed_[i] != 0) changed.push_back({activeWords_[i], changed_[i]});
            }
            activeWords_.clear();
            activateAround(changed);
            rememberBirths(round);
            if (changed.empty() && round >= lastLayer_) return;
        }
    }

    /// Adds the corners to those of the next round. A word that had no active corner joins `words`.
    void activate(Some some, std::vector<std::size_t>& words) {
        if (some.corners == 0) return;
        const std::atomic_ref active(active_[some.word]);
        if (active.fetch_or(some.corners, std::memory_order_relaxed) == 0) {
            words.push_back(some.word);
        }
    }

    /// Adds the corners and their 26 neighbours to those of the next round, except for corners
    /// without cells.
    void activateAround(const std::vector<Some>& centres) {
        std::vector<std::vector<std::size_t>> parts((centres.size() + kPerTask - 1) / kPerTask);
        pool_.forEach(parts.size(), [&](std::size_t task) {
            const std::size_t end = std::min(centres.size(), (task + 1) * kPerTask);
            for (std::size_t i = task * kPerTask; i < end; ++i) {
                const Word own = centres[i].corners;
                const Word along[3] = {own << 63, own | own << 1 | own >> 1, own >> 63};
                for (int row = 0; row < 9; ++row) {
                    const Shift to =
                        complex().shift(1, row % 3 - 1) + complex().shift(2, row / 3 - 1);
                    for (std::size_t n = 0; n < 3; ++n) {
                        if (along[n] == 0) continue;
                        const std::size_t w = centres[i].word + std::size_t(to.words) + n - 1;
                        activate({w, along[n] & complex().word(w, 0)}, parts[task]);
                    }
                }
            }
        });
        for (const auto& p : parts) activeWords_.insert(activeWords_.end(), p.begin(), p.end());
    }

    /// Removes all pairs that are free in this direction and dimension. It finds them in one loop
    /// and removes them in another: a pair that a removal makes free waits for the next step.
    void step(int axis, bool high, int dimension) {
        std::vector<CellAxes> kinds;
        for (CellAxes axes = 1; axes < 8; ++axes) {
            if (std::popcount(axes) == dimension && (axes >> axis & 1u)) kinds.push_back(axes);
        }
        found_.resize((activeWords_.size() + kPerTask - 1) / kPerTask);
        pool_.forEach(found_.size(), [&](std::size_t task) {
            Found& found = found_[task];
            found.pairs.clear();
            found.waiting.clear();
            const std::size_t end = std::min(activeWords_.size(), (task + 1) * kPerTask);
            for (std::size_t i = task * kPerTask; i < end; ++i) {
                // Words are scattered in memory: without prefetching, most of the time would be
                // spent waiting for it.
                if (i + kAhead < end) complex().prefetch(activeWords_[i + kAhead]);
                for (const CellAxes axes : kinds) {
                    const Word free = mayGo(activeWords_[i], axes, axis, high, found.waiting);
                    if (free == 0) continue;
                    found.pairs.push_back({{activeWords_[i], free}, axes});
                    changed_[i] |= free;
                }
            }
        });
        const Shift toFace = high ? complex().shift(axis, 1) : Shift{};
        pool_.forEach(found_.size(), [&](std::size_t task) {
            for (const auto& [some, axes] : found_[task].pairs) {
                complex().remove(some.word, axes, some.corners);
                const CellAxes face = axes & ~(1u << axis);
                const std::size_t at = some.word + std::size_t(toFace.words);
                complex().remove(at, face, toFace.bits ? some.corners << 1 : some.corners);
                if (toFace.bits && some.corners >> 63) complex().remove(at + 1, face, 1);
            }
        });
        for (const Found& f : found_) {
            for (const auto& [layer, c] : f.waiting) waiting_[layer].push_back(c);
        }
    }

    /// The active corners of the word whose cell along `axes` forms a free pair with its face at
    /// the low or high end of `axis` and may be removed. A cell that must wait for its layer is
    /// added to `waiting` once.
    Word mayGo(std::size_t w, CellAxes axes, int axis, bool high,
               std::vector<std::pair<std::size_t, Corner>>& waiting) {
        Word free = complex().word(w, axes) & active_[w];
        if (free == 0) return 0;
        // A pair is free if the face belongs to no other cell.
        const Shift beyond = complex().shift(axis, high ? 1 : -1);
        const Shift toFace = high ? beyond : Shift{};
        free &= ~complex().word(w, axes, beyond);
        for (int a = 0; a < 3; ++a) {
            if (axes >> a & 1u) continue;
            const CellAxes other = (axes & ~(1u << axis)) | 1u << a;
            free &= ~(complex().word(w, other, toFace) |
                      complex().word(w, other, toFace + complex().shift(a, -1)));
        }
        if (free == 0) return 0;
        Word allowed = ~Word(0);
        for (CellAxes back = 0; back < 8; ++back) {
            if (back & axes) continue;
            allowed &= CubicalComplex::shifted([&](std::size_t at) { return allowed_[at]; }, w,
                                               backwards(back));
        }
        Word& recorded = recorded_[axes][w];
        forEachCorner({w, free & ~allowed & ~recorded}, [&](Corner c) {
            waiting.push_back({complex().largestAround(c, axes, layer_), c});
        });
        recorded |= free & ~allowed;
        free &= allowed;
        if (std::popcount(axes) == 1) {
            forEachCorner({w, free & born_[std::size_t(axis)][w]}, [&](Corner c) {
                if (isEnd(c, axes)) free &= ~(Word(1) << c % 64);
            });
        }
        return free;
    }

    /// Whether an edge without squares has lived long enough to be the end of a branch.
    bool isEnd(Corner c, CellAxes axes) const {
        return result_.rounds - birth_.at(edgeKey(c, axes)) >
               complex().largestAround(c, axes, opening_);
    }

    static std::uint64_t edgeKey(Corner c, CellAxes axes) { return std::uint64_t(c) * 8 + axes; }

    void rememberBirths(std::size_t round) {
        for (const std::size_t w : activeWords_) {
            for (int a = 0; a < 3; ++a) {
                const CellAxes axes = 1u << a;
                Word& born = born_[std::size_t(a)][w];
                Word alone = complex().word(w, axes) & active_[w] & ~born;
                for (int b = 0; b < 3 && alone != 0; ++b) {
                    if (b == a) continue;
                    const CellAxes square = axes | 1u << b;
                    alone &= ~(complex().word(w, square) |
                               complex().word(w, square, complex().shift(b, -1)));
                }
                born |= alone;
                forEachCorner({w, alone},
                              [&](Corner c) { birth_.emplace(edgeKey(c, axes), round); });
            }
        }
    }

    /// Removes one square of every sheet around a cavity. Regions are the components of the
    /// complex's complement: absent cubes, connected through absent squares.
    std::size_t puncture() {
        struct Square {
            std::size_t layer;
            Corner corner;
            CellAxes axes;
            auto operator<=>(const Square&) const = default;
        };
        std::vector<Square> squares;
        for (std::size_t w = 0; w < complex().words(); ++w) {
            for (const CellAxes axes : {3u, 5u, 6u}) {
                forEachCorner({w, complex().word(w, axes)}, [&](Corner c) {
                    squares.push_back({complex().largestAround(c, axes, layer_), c, axes});
                });
            }
        }
        if (squares.empty()) return 0;
        std::sort(squares.begin(), squares.end());

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
        std::vector<Some> opened;
        for (const Square& s : squares) {
            const std::size_t a = find(s.corner);
            const std::size_t b = find(s.corner - complex().step(normalOf(s.axes)));
            if (a == b) continue;
            parent[std::max(a, b)] = std::uint32_t(std::min(a, b));
            complex().remove(s.corner, s.axes);
            opened.push_back({s.corner / 64, Word(1) << s.corner % 64});
        }
        result_.punctures += opened.size();
        activateAround(opened);
        return opened.size();
    }

    const ThreadPool& pool_;
    const std::atomic<bool>& cancel_;
    Thinned result_;
    // By corner: values of the cube there.
    std::vector<std::uint16_t> layer_;  // round from which on it may be removed
    std::vector<std::uint16_t> opening_;
    std::size_t lastLayer_ = 0;
    // By layer: words that have cubes of it, and corners of free pairs that wait for its round.
    std::vector<std::vector<std::size_t>> opens_;
    std::vector<std::vector<Corner>> waiting_;
    // By word, one bit per corner. allowed_: its cube may be removed. active_: it belongs to this
    // round. recorded_ (by axes): its cell has been put on a waiting list. born_ (by axis): its
    // edge has an entry in birth_.
    std::vector<Word> allowed_, active_;
    std::array<std::vector<Word>, 8> recorded_;
    std::array<std::vector<Word>, 3> born_;
    std::vector<std::size_t> activeWords_;  // words with active corners
    std::vector<Word> changed_;             // by entry of activeWords_: corners that lost a cell
    std::vector<Found> found_;              // by task: scratch memory of step()
    std::unordered_map<std::uint64_t, std::size_t> birth_;  // round that left the edge bare
};

}  // namespace

Thinned thin(const VoxelSpace& space, const ThreadPool& pool, const std::atomic<bool>& cancel) {
    return Thinning(space, pool, cancel).run();
}

}  // namespace lacuna

// Light vertices of a pool by the length of their prefix, and pmfs over one length that combine
// several pmfs: what skelbpt and icbpt have in common. (theory.md, "Lengths")
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/alias_table.h"
#include "libcore/bidir/method.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

/// The vertices of a pool that picks choose from (takePickable), sorted by s.
class VerticesByLength {
  public:
    /// With `direct`, vertices on the lights themselves (s = 1) are among them.
    void assign(const LightPool& pool, bool direct);

    /// The largest s. Some smaller ones may have no vertices.
    int lengths() const { return int(begin_.size()) - 2; }
    std::size_t size() const { return entries_.size(); }
    std::size_t begin(int s) const { return begin_[std::size_t(s)]; }
    std::size_t count(int s) const { return begin_[std::size_t(s) + 1] - begin_[std::size_t(s)]; }
    /// y_0 .. y_{s-1} of a vertex, by its place in [0, size()).
    Subpath prefix(std::size_t place) const { return pool_->prefix(entries_[place]); }

  private:
    const LightPool* pool_ = nullptr;
    std::vector<LightPool::Entry> entries_;
    std::vector<std::size_t> begin_{0, 0};  // by s
};

/// For which s an eye vertex picks light vertices.
enum class Lengths { Every, Share };

/// How many picks an eye vertex gets for each s: N, as in the papers. With Lengths::Share and s
/// > 2 it gets fewer on average, by the share of light subpaths that had a y_{s-1} in earlier
/// iterations. So lengths that carry less are picked less often (in bpt the light subpath
/// itself decides).
class LengthPicks {
  public:
    LengthPicks(Lengths lengths, const Picks& picks) : lengths_(lengths), picks_(picks) {}

    /// n: the picks of length s that an eye vertex gets on average, by its Connection::order;
    /// positive. It is chance x repeats.
    double at(int s, int order) const { return picks_.at(order) * share(s); }
    /// The probability that there is a pick.
    double chance(int s, int order) const { return std::min(1.0, at(s, order)); }
    /// How many picks there are on average, if there is one.
    double repeats(int s, int order) const { return std::max(1.0, at(s, order)); }

    /// Calls visit(s, u, n) for every pick of an eye vertex, with u in [0, 1) for it.
    template <class Visit>
    void forEachPick(const VerticesByLength& vertices, int order, Rng& rng,
                     const Visit& visit) const {
        for (int s = 1; s <= vertices.lengths(); ++s) {
            if (vertices.count(s) == 0) continue;
            const double n = at(s, order);
            for (double left = n; left > 0.0; left -= 1.0) {
                const double draw = rng.uniformDouble(), probability = std::min(1.0, left);
                if (draw < probability) visit(s, draw / probability, n);
            }
        }
    }

    /// Counts the vertices by length, for later iterations.
    void learn(const VerticesByLength& vertices) {
        seen_.resize(std::max(seen_.size(), std::size_t(vertices.lengths()) + 1));
        for (int s = 1; s <= vertices.lengths(); ++s) seen_[std::size_t(s)] += vertices.count(s);
    }

  private:
    static constexpr double kPicksForTheShare = 2.0;  // among light subpaths with a y_1

    /// n over N, in (0, 1].
    double share(int s) const {
        const auto i = std::size_t(s);
        if (lengths_ == Lengths::Every || s <= 2 || i >= seen_.size() || seen_[i] == 0)
            return 1.0;  // also for a length that was never seen
        return std::min(1.0, kPicksForTheShare * double(seen_[i]) / double(seen_[2]));
    }

    Lengths lengths_;
    Picks picks_;
    std::vector<std::uint64_t> seen_;  // by s, over all iterations
};

/// `lengths`, of rows with LengthPicks.
template <class Record, class Field>
void addLengths(OptionTable<Record>& table, Field field) {
    table.template choice<Lengths>(
        "lengths", field, {{"every", Lengths::Every}, {"share", Lengths::Share}},
        "for which s a vertex is picked: for every s (the paper), or with a probability that "
        "follows the share of light subpaths of that length");
}

/// The number of samples that the weights believe of a connection.
enum class Believed {
    Credit,  ///< M samples: the papers' constant
    Aware,   ///< the samples that the resampling is worth
};

/// `weights`: which of the two.
template <class Record, class Field>
void addBelieved(OptionTable<Record>& table, Field field) {
    table.template choice<Believed>(
        "weights", field, {{"credit", Believed::Credit}, {"aware", Believed::Aware}},
        "density that the weights use: M samples per connection (the paper), or resampling-aware");
}

/// One pmf made of several over the same outcomes, with the maximum heuristic [Veach97 9.2.3]
/// multiplied in. An outcome belongs to the pmf that gives it the highest probability (ties: to the
/// first), and the others drop it. Each pmf is normalised anew, and one of those that hold outcomes
/// is chosen evenly [Noel15 eq 9]. Choosing and then drawing is the same as drawing from one pmf
/// over all outcomes.
class CombinedPmf {
  public:
    CombinedPmf() = default;
    /// `targets` are weights of any sum, all over the same outcomes. Targets that sum to
    /// zero are left out.
    explicit CombinedPmf(std::span<const std::span<const double>> targets);

    bool empty() const { return pmf_.empty(); }
    AliasTable::Pick sample(double u) const { return pmf_.sample(u); }
    double pmf(std::size_t outcome) const { return pmf_.pmf(outcome); }
    /// The target whose pmf the outcome belongs to.
    std::uint32_t owner(std::size_t outcome) const { return owner_[outcome]; }

    /// Sum of a target's weights.
    double sum(std::size_t target) const { return sum_[target]; }
    /// Sum over the outcomes of the highest probability that a target gives them, between 1 and the
    /// number of targets. Zero where empty().
    double maxima() const { return maxima_; }
    std::uint64_t bytes() const { return pmf_.bytes() + owner_.size(); }

  private:
    AliasTable pmf_;
    std::vector<std::uint8_t> owner_;
    std::vector<double> sum_;
    double maxima_ = 0.0;
};

std::uint64_t bytesOf(std::span<const CombinedPmf> pmfs);

}  // namespace lacuna

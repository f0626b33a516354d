// How often eye vertices are connected, and what weights believe of so many picks: what methods
// have in common. (theory.md, "Picks")
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "libcore/base/options.h"
#include "libcore/bidir/method.h"

namespace lacuna {

/// N: how often an eye vertex is connected, by its Connection::order.
struct Picks {
    static constexpr int kMost = 64;

    int first;  ///< the pixel determines this vertex: only the light subpath is random
    int second;
    int later;

    int at(int order) const { return order <= 1 ? first : order == 2 ? second : later; }
    bool alike() const { return first == second && second == later; }
};

/// N as the user sets it.
struct PickOptions {
    int connections = 1;
    int first = 0;  ///< 0: connections
    int deep = 0;   ///< after the first two; 0: connections

    Picks picks() const {
        return {first > 0 ? first : connections, connections, deep > 0 ? deep : connections};
    }
};
/// `connections` and `first_connections`, and `deep_connections` where `deep`.
OptionTable<PickOptions> pickOptions(const PickOptions& defaults, bool deep = false);

/// `lamps`, of every method with next event.
template <class Record, class Field>
void addLamps(OptionTable<Record>& table, Field field) {
    table.template choice<Lamps>(
        "lamps", field, {{"seen", Lamps::Seen}, {"power", Lamps::Power}},
        "how next event picks a lamp: by what the eye vertex can see of it, or by power alone");
}

/// `next_event`, a switch of every method that may take s = 1 from the pool, and `lamps`.
template <class Record, class Field, class LampsField>
void addNextEvent(OptionTable<Record>& table, Field field, LampsField lamps) {
    table.onOff("next_event", field,
                "on: s = 1 takes a fresh light point for each eye vertex; off: it takes the light "
                "points of the light paths");
    addLamps(table, lamps);
}
/// ConnectionDensity::lamps of those methods.
inline Lamps lampsOf(bool nextEvent, Lamps lamps) {
    return nextEvent ? lamps : Lamps::Power;
}

/// `eye_share`: see withEyeShare.
template <class Record, class Field>
void addEyeShare(OptionTable<Record>& table, Field field) {
    table.real("eye_share", field, 0, 1, "share",
               "of the variance that all picks at one eye vertex have in common, as the weights "
               "assume at all but the first eye vertex; 0: none (the paper)");
}

/// n r of picks that differ in their light subpath alone. `share` of a connection's variance is
/// that of the eye subpath, which all picks have in common [Grittmann21]. `samples` is n r
/// without this: one stays one, and any number counts as 1 / share at most. The first eye
/// vertex (Connection::order) keeps `samples`, because the pixel determines it. (theory.md,
/// "Eye subpaths")
double withEyeShare(double samples, int order, double share);

/// Replaces `entries` by what picks choose from: the pool's connectable vertices, with those on the
/// lights themselves (s = 1) where `direct`.
void takePickable(const LightPool& pool, bool direct, std::vector<LightPool::Entry>& entries);

/// A choice among n equally likely outcomes, the i-th of an eye vertex's `picks`. `u` in [0, 1) is
/// left for further choices.
struct Choice {
    std::uint32_t index;
    double u;
};
inline Choice choose(Rng& rng, std::uint32_t n, int i, int picks) {
    if (!rng.isEven()) {
        const std::uint32_t index = rng.below(n);
        return {index, rng.uniformDouble()};
    }
    const double u = rng.evenPick(std::uint32_t(i), std::uint32_t(picks)) * double(n);
    const auto index = std::uint32_t(u);  // below n: the product is rounded down
    return {index, u - double(index)};
}

/// Mean number of vertices that pools had to pick from. At least one: any positive number is
/// unbiased, and one stands in where none was seen.
class ExpectedVertices {
  public:
    void add(std::size_t vertices) {
        vertices_ += vertices;
        ++pools_;
    }
    double value() const {
        return pools_ ? std::max(1.0, double(vertices_) / double(pools_)) : 1.0;
    }

  private:
    std::uint64_t vertices_ = 0, pools_ = 0;
};

/// Proposes one fresh light point: next event (s = 1). With lamps=power r = 1, otherwise r
/// = seenSamples.
void proposeFreshLight(const EyeContext& context, Lamps lamps, Rng& rng, ProposalSink& sink);

/// A density that depends on nothing but whether s = 1.
class ConstantDensity final : public ConnectionDensity {
  public:
    ConstantDensity(double direct, double indirect, Lamps lamps = Lamps::Power)
        : constants_{direct, indirect}, lamps_(lamps) {}
    std::optional<Constants> constants() const override { return constants_; }
    double effectiveSamples(const Connection& c) const override {
        return c.light.count == 1 ? constants_.direct : constants_.indirect;
    }
    Lamps lamps() const override { return lamps_; }

  private:
    Constants constants_;
    Lamps lamps_;
};

/// n r where every pick is worth the same r: picks x r. With next event s = 1 has one sample.
class PicksDensity final : public ConnectionDensity {
  public:
    PicksDensity(const Picks& picks, bool nextEvent, Lamps lamps, double r)
        : picks_(picks), nextEvent_(nextEvent), lamps_(lamps), r_(r) {}
    std::optional<Constants> constants() const override {
        if (!picks_.alike()) return std::nullopt;
        return Constants{at(1, 1), at(2, 1)};
    }
    double effectiveSamples(const Connection& c) const override {
        return at(c.light.count, c.order);
    }
    Lamps lamps() const override { return lampsOf(nextEvent_, lamps_); }

  private:
    double at(int s, int order) const { return nextEvent_ && s == 1 ? 1.0 : picks_.at(order) * r_; }

    Picks picks_;
    bool nextEvent_;
    Lamps lamps_;
    double r_;
};

}  // namespace lacuna

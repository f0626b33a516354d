// One function per row of the registry; each is defined in the file that bears the method's name.
#pragma once

#include "libcore/methods/registry.h"

namespace lacuna {

MethodRow pathTracingRow();               // pt.cpp
MethodRow lightTracingRow();              // lt.cpp
MethodRow bidirectionalRow();             // bpt.cpp
MethodRow lvcRow();                       // lvcbpt.cpp
MethodRow probabilisticConnectionsRow();  // pcbpt.cpp
MethodRow resamplingAwareRow();           // risbpt.cpp
MethodRow currentSetRow();                // risbpt.cpp, biased
MethodRow twoStageResamplingRow();        // tsr.cpp
MethodRow importanceCachingRow();         // icbpt.cpp
MethodRow skeletonRow();                  // skelbpt.cpp
MethodRow subspaceRow();                  // spcbpt.cpp
MethodRow subspaceQueueRow();             // spcbpt.cpp; biased

/// `light_paths`: L, the light subpaths per iteration that splat (t = 1).
Parameter lightPathsParameter();
/// `next_event`: s = 1 by fresh light points instead of the pool's y_0.
Parameter nextEventParameter(bool defaultOn);

/// `preset`: our defaults, or those of the row's paper.
Parameter presetParameter();

/// N: how often an eye vertex is connected, by its Connection::order.
struct Picks {
    static constexpr int kMost = 64;

    int first;  ///< the pixel determines it: nothing but the light subpath is random
    int second;
    int later;

    int at(int order) const { return order <= 1 ? first : order == 2 ? second : later; }
    bool alike() const { return first == second && second == later; }
};
/// `connections`: N at every eye vertex that no other parameter speaks of.
Parameter connectionsParameter(int value);
/// `first_connections`: N at the first; 0: `connections`.
Parameter firstConnectionsParameter(int value);
/// What the two say.
Picks picksOf(const Settings& settings);

/// `eye_share`: see withEyeShare.
Parameter eyeShareParameter(double value);
/// n r where picks differ in their light subpath alone: a share of a connection's variance is that
/// of its eye subpath, which all of them have in common [Grittmann21]. `samples` are what light
/// subpaths count as; one stays one, and any number counts as 1 / share at most. Not so at the
/// first eye vertex (Connection::order), which the pixel determines.
double withEyeShare(double samples, int order, double share);

/// Proposes one fresh light point: next event (s = 1, r = 1).
void proposeFreshLight(const EyeContext& context, Rng& rng, ProposalSink& sink);

/// A density that depends on nothing but whether s = 1.
class ConstantDensity final : public ConnectionDensity {
  public:
    ConstantDensity(double direct, double indirect) : constants_{direct, indirect} {}
    std::optional<Constants> constants() const override { return constants_; }
    double effectiveSamples(const Connection& c) const override {
        return c.light.count == 1 ? constants_.direct : constants_.indirect;
    }

  private:
    Constants constants_;
};

/// n r where every pick is worth the same r: picks x r. With next event s = 1 has one sample.
class PicksDensity final : public ConnectionDensity {
  public:
    PicksDensity(const Picks& picks, bool nextEvent, double r)
        : picks_(picks), nextEvent_(nextEvent), r_(r) {}
    std::optional<Constants> constants() const override {
        if (!picks_.alike()) return std::nullopt;
        return Constants{at(1, 1), at(2, 1)};
    }
    double effectiveSamples(const Connection& c) const override {
        return at(c.light.count, c.order);
    }

  private:
    double at(int s, int order) const { return nextEvent_ && s == 1 ? 1.0 : picks_.at(order) * r_; }

    Picks picks_;
    bool nextEvent_;
    double r_;
};

}  // namespace lacuna

// A pixel's eye walk that it lends to pixels beside it, whose walks could have gone the same way [Bekaert02].
// (theory.md, "Shared walks")
#pragma once

#include <array>

#include "libcore/bidir/sharing.h"
#include "libcore/bidir/tile.h"
#include "libcore/bidir/walk.h"

namespace lacuna {

class LentWalk {
  public:
    /// Whether z_h is a vertex that walks may be exchanged at: nothing but delta events before it.
    static bool forksAt(Subpath walk, std::size_t h);
    /// h, if the walk goes on from z_h to a vertex that others may go on from. Zero if it does not.
    static std::size_t begin(Subpath walk);

    /// Lends what lies behind z_h of `walk`, h = begin(walk). All arguments must
    /// outlive this object.
    LentWalk(const Walker& walker, Subpath walk, std::size_t h)
        : walker_(&walker), walk_(walk), h_(h) {}

    /// The lent subpaths z_0 .. z_{t-1} have t in [firstEnd(), lastEnd()]. What is behind lastEnd() was found by a
    /// delta event, which leads another walk elsewhere.
    std::size_t firstEnd() const { return h_ + 2; }
    std::size_t lastEnd() const { return goesOn() ? walk_.size() : h_ + 2; }

    /// Adds the next walk that forks at z_h. The lending walk itself must be one of them, at most kTile in all. Traces
    /// a shadow ray for every other one.
    void add(Subpath borrower, RayTally& tally);
    /// Whether the walk that was added as number `i` could have gone this way.
    bool leadsFrom(std::size_t i) const { return from_[i].pdfA > 0.0; }
    /// Ratio of what walks number i and k carry to z_{h+1}. Zero where k carries nothing.
    double brightness(std::size_t i, std::size_t k) const;
    /// Replaces `out` by z_0 .. z_{t-1}: number i's vertices up to z_h, the lent ones behind it. Throughputs are
    /// weighted by the balance heuristic over all walks that could have gone this way.
    void take(std::size_t i, std::size_t t, std::vector<PathVertex>& out) const;

  private:
    struct From {
        Subpath walk;
        Edge edge;            ///< to z_{h+1}
        BsdfEvaluation at;    ///< of z_h towards z_{h+1}
        Rgb arrives;          ///< at z_{h+1}, not divided by any density
        BsdfEvaluation next;  ///< of z_{h+1} towards z_{h+2}
        double pdfA;          ///< of z_{h+1}, roulette included; zero: could not have come there
    };
    bool goesOn() const { return walk_.size() > h_ + 2 && !isDelta(walk_[h_ + 1].event); }

    const Walker* walker_;
    Subpath walk_;
    std::size_t h_;
    std::size_t count_ = 0;
    std::array<From, kTile> from_;
    double sum_ = 0;      ///< of the densities of z_{h+1}
    double sumNext_ = 0;  ///< of those densities times the pdfW towards z_{h+2}
};

}  // namespace lacuna

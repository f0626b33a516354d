// A pixel's eye walk, as those of the pixels beside it could have gone it as well [Bekaert02]. (theory.md, "Shared
// walks")
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
    /// h where it goes on from there to a vertex that others may go on from; zero where it does not.
    static std::size_t begin(Subpath walk);

    /// The walk lends what lies behind z_h, h = begin(walk). All must outlive it.
    LentWalk(const Walker& walker, Subpath walk, std::size_t h)
        : walker_(&walker), walk_(walk), h_(h) {}

    /// z_{t-1} of what it lends lies in [firstEnd(), lastEnd()], as t; what is behind lastEnd() was found by
    /// a delta event, which leads elsewhere from elsewhere.
    std::size_t firstEnd() const { return h_ + 2; }
    std::size_t lastEnd() const { return goesOn() ? walk_.size() : h_ + 2; }

    /// The next one that forks at z_h; the walk itself is one of them. Traces a ray, unless it is its own.
    /// At most kTile.
    void add(Subpath borrower, RayTally& tally);
    /// Whether the one that was added as number `i` could have gone this way.
    bool leadsFrom(std::size_t i) const { return from_[i].pdfA > 0.0; }
    /// How much more it carries to z_{h+1} than number k does.
    double brightness(std::size_t i, std::size_t k) const;
    /// Replaces `out` by z_0 .. z_{t-1}: number i's up to z_h, the walk's behind it, with the throughput
    /// of a sample of all those who could have gone this way, weighed by the balance heuristic.
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
    double sumNext_ = 0;  ///< and of those times that of z_{h+2}'s direction
};

}  // namespace lacuna

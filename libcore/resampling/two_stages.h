// Picks in two stages: a light subspace by Gamma, then a vertex of it by its throughput
// [Su22 6.1, eq 9]. (theory.md, "spcbpt")
#pragma once

#include <span>
#include <vector>

#include "libcore/base/alias_table.h"
#include "libcore/bidir/method.h"

namespace lacuna {

/// The light vertices of a subspace that may be picked: LVC_i.
struct LightCell {
    std::vector<Subpath> members;
    double iterations = 1.0;  ///< that the members stand for
    AliasTable within;        ///< P_r [eq 9]

    /// Makes `within` from the members.
    void makeTable();
};

/// Proposes a light vertex for each of `numbers`, u in [0, 1), at most Picks::kMost of them. Its weight is 1 /
/// (`picksTimesPaths` P) over the cell's iterations, with P the probability of both stages. `cells` are by light
/// subspace; an empty one gives nothing and counts as a pick.
void pickInTwoStages(std::span<const double> numbers, const AliasTable& column,
                     std::span<const LightCell> cells, double picksTimesPaths, ProposalSink& sink);

/// n r of `n` picks of a vertex of this mean `beta`, out of `m` subpaths. Its subspace has probability `gamma`, and its
/// cell holds `q` per subpath on average. (theory.md, "spcbpt")
inline double twoStageSamples(double m, double n, double gamma, double beta, double q) {
    // The fractions of r are brought to one: a division costs as much as all the rest.
    return m * n * gamma * beta / (beta + (m - 1.0) * q + (n - 1.0) * gamma * beta);
}

}  // namespace lacuna

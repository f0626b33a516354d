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
    double iterations = 1.0;  ///< that they stand for
    AliasTable within;        ///< P_r [eq 9]

    /// Of the members that there are.
    void makeTable();
};

/// Proposes a light vertex for each of `numbers`, u in [0, 1): at most Picks::kMost of them, with the
/// weight 1 / (`picksTimesPaths` P), P the probability of both stages. Cells by light subspace; an empty
/// one gives nothing and counts as a pick.
void pickInTwoStages(std::span<const double> numbers, const AliasTable& column,
                     std::span<const LightCell> cells, double picksTimesPaths, ProposalSink& sink);

/// n r of N picks of a vertex of that beta, out of `m` subpaths whose cell holds q per subpath in the
/// mean. (theory.md, "spcbpt")
inline double twoStageSamples(double m, double n, double gamma, double beta, double q) {
    // Both fractions of r brought to one: divisions cost as much as all the rest.
    return m * n * gamma * beta / (beta + (m - 1.0) * q + (n - 1.0) * gamma * beta);
}

}  // namespace lacuna

// Everything that SPCBPT knows before it renders: the classification of light and eye subpaths, Q
// and Gamma [Su22 6]. lacuna-train makes it, the method `spcbpt` reads it, and it is frozen.
// (theory.md, "Subspaces")
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/subspace/decision_tree.h"
#include "libcore/subspace/light_cells.h"

namespace lacuna {

/// Light subspaces are the cells of the lights (s = 1), and then those of the light tree (s >= 2),
/// whose labels go on from there. Positions are the recentred scene's. By default there is one
/// subspace on either side, and Q is unknown.
struct Subspaces {
    static constexpr std::uint32_t kMost = 0xfffe;  ///< largest number of subspaces of a side

    LightCells cells;
    DecisionTree lightTree, eyeTree;
    std::uint32_t lightCount = 1, eyeCount = 1;
    /// Q(i) = (1/M') sum of mean(beta) over the vertices in i of M' light subpaths [Su22 eq 19];
    /// empty: not measured. In the lights' unit (Lights::unit), as beta is.
    std::vector<double> q;
    /// Vertices in i per light subpath, measured with Q; as many as of Q.
    std::vector<double> population;
    std::uint64_t lightPaths = 0;  ///< M'
    /// Gamma(i given j) with its uniform part, a column for each eye subspace. A
    /// column sums to one.
    std::vector<float> gamma = {1.0f};

    /// kappa of y_0 .. y_{s-1} that ends with `vertex`; `predecessor` is null for s = 1.
    std::uint32_t lightSubspace(const PathVertex& vertex, const PathVertex* predecessor) const {
        return predecessor ? lightTree(subpathEnd(vertex, *predecessor)) : cells.cellOf(vertex);
    }
    /// The same as a look-up that is still to be finished.
    DecisionTree::Descent toLightSubspace(const PathVertex& vertex,
                                          const PathVertex* predecessor) const {
        return predecessor ? DecisionTree::Descent(lightTree, subpathEnd(vertex, *predecessor))
                           : DecisionTree::Descent(cells.cellOf(vertex));
    }
    /// kappa of z_0 .. z_{t-1} that ends with `vertex`.
    std::uint32_t eyeSubspace(const PathVertex& vertex, const PathVertex& predecessor) const {
        return eyeTree(subpathEnd(vertex, predecessor));
    }
    /// The column of Gamma of an eye subspace: lightCount probabilities.
    std::span<const float> column(std::uint32_t eye) const {
        return std::span(gamma).subspan(std::size_t(eye) * lightCount, lightCount);
    }

    /// Throws std::invalid_argument naming what does not fit together.
    void check() const;
    /// Hash of everything above, as hexadecimal digits.
    std::string contentHash() const;
};

/// The value that stands in for Q(i) where no light subpath was seen in i: as if one of average
/// power had come. Positive for any q.
double unseenQ(std::span<const double> q, std::uint64_t lightPaths);

}  // namespace lacuna

// Gamma(i given j), the probability of light subspace i for an eye vertex in subspace j, that
// minimises an upper bound of the variance [Su22 6.3, 7.3]. (theory.md, "Subspaces")
//
//     Loss(E) = (1/|D|) sum over X in D of f^2(X) / (p_D(X) F(X))               [Su22 eq 15, 7.3]
//     F(X)    = g_0(X) + sum_ij g_ij(X) E_ij                                      [Su22 eq 16]
//     E       = (1 - c) q + c / N_S,  every column of q sums to one,  c = 0.1
//
// g_0: what t = 1 and s = 0 add to n p; g_ij: what the connections of subspaces (i, j) add per unit
// of E. A path has f / p_D and F / p_D (training_paths.h says where they come from).
//
// The loss is convex in q. With d_ij = dLoss/dE_ij = -(1/|D|) sum f^2 g_ij / (p_D F^2), Jensen's
// inequality for 1/F bounds the loss by sum_ij q_ij^2 (-d_ij) / q'_ij, column by column, with
// equality at q' = q. The bound is least for
//     q'_ij  proportional to  q_ij sqrt(-d_ij),
// so a step never raises the loss on the paths that it is made from, keeps columns on the simplex
// and needs no rate. The paper descends along logits with Adam instead.
//
// A million entries follow a million heavy-tailed paths too closely: Gamma^full is twice as bad on
// paths that it was not made from. So every column borrows from the eye subspaces around it, level
// by level, the widest neighbourhood first, as n-grams do from shorter ones [MacKay95]:
//     m^0   = the column of all eye subspaces together
//     m_j^l = (n_j^l a_j^l + kappa m_j^(l-1)) / (n_j^l + kappa),   l: the 128, 32, 8 nearest ones
//     start = (n_j Gamma^full_j + kappa m_j) / (n_j + kappa),      m_j: that of the last level
// n is an effective number of paths, kappa a number of virtual paths. In a neighbourhood's column
// a^l light subspaces borrow as well, from their 4 nearest, in proportion to m^0. kappa is the one
// of a few values under which the start has the lowest held-out loss. In the optimisation the
// virtual paths are worth as much as the column's own on average:
//     + sum_j lambda_j sum_i m_ij^2 / E_ij,   lambda_j = kappa / n_j sum_i E_ij (-d_ij)
//     at the start.
// This term is convex, is least at E_j = m_j, and is one more -d_ij in the step above.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lacuna {

class ThreadPool;

/// Share of every column that is uniform: no subspace is ever out of reach.
inline constexpr double kUniformShare = 0.1;

/// The paths of D as the loss sees them.
struct GammaData {
    struct Entry {
        std::uint32_t light, eye;  ///< i, j
        float g;                   ///< g_ij / p_D > 0
    };
    std::uint32_t lightCount = 1, eyeCount = 1;
    std::vector<float> contribution;      ///< by path: f / p_D, relative to the pixel
    std::vector<float> fixed;             ///< by path: g_0 / p_D
    std::vector<std::uint64_t> begin{0};  ///< by path: its first entry; one more than paths
    std::vector<Entry> entries;

    std::size_t paths() const { return contribution.size(); }
    std::span<const Entry> entriesOf(std::size_t path) const {
        return std::span(entries).subspan(begin[path], begin[path + 1] - begin[path]);
    }
    /// Ends a path. Its entries are those that were pushed to `entries` since the path before.
    void endPath(float relativeContribution, float fixedDensity) {
        contribution.push_back(relativeContribution);
        fixed.push_back(fixedDensity);
        begin.push_back(entries.size());
    }
};

/// A matrix over (eye, light) subspaces, column by column.
using SubspaceMatrix = std::vector<double>;

/// By subspace of a side, the subspaces that lie near it: indices, nearest first,
/// itself among them.
struct SubspaceNeighbours {
    std::vector<std::vector<std::uint32_t>> light, eye;
};

/// Numbers of eye subspaces that a column borrows from, level by level.
inline constexpr std::size_t kNeighbourhoods[] = {128, 32, 8};
inline constexpr std::size_t kMostNeighbours = kNeighbourhoods[0];

/// Columns by eye subspace and how many paths speak for each.
struct GammaColumns {
    SubspaceMatrix q;           ///< every column sums to one; no entry is 0
    std::vector<double> paths;  ///< n_j, effective: (sum c)^2 / sum c^2 of the contributions
};

/// Gamma^full and what its columns borrow from.
struct FullGamma : GammaColumns {
    std::vector<double> mean;          ///< m^0, by light subspace; sums to one
    std::vector<GammaColumns> around;  ///< a^l, widest neighbourhoods first
};

/// Gamma^full: the contributions of D by the subspaces of its connections [Su22 eq 13]. A column
/// without any is uniform. Every column sums to one. No entry is 0, because a step could not raise
/// it again. `around` is empty.
FullGamma fullGamma(const GammaData& data);

/// The same with `around`. `neighbours` are those of all subspaces of `data`.
FullGamma fullGamma(const GammaData& data, const SubspaceNeighbours& neighbours,
                    const ThreadPool& pool);

/// (1 - c) q + c / N_S.
SubspaceMatrix mixedGamma(const SubspaceMatrix& q, std::uint32_t lightCount);

/// Loss(E) of data; 0 without paths. Sets `derivative` to dLoss/dE, where it is not null.
double gammaLoss(const GammaData& data, const SubspaceMatrix& e, const ThreadPool& pool,
                 SubspaceMatrix* derivative = nullptr);

struct GammaResult {
    SubspaceMatrix gamma;                               ///< E
    double fullTrainLoss = 0.0, fullHeldOutLoss = 0.0;  ///< of Gamma^full
    double virtualPaths = 0.0;                          ///< kappa
    /// Loss on the training and the held-out paths by epoch; first that of the start.
    std::vector<double> trainLoss, heldOutLoss;
    std::size_t kept = 0;  ///< the epoch of `gamma`: that of the lowest held-out loss
};

struct GammaSettings {
    int epochs = 20;
    bool borrow = true;  ///< off: kappa = 0, every column stands for itself
};

/// Optimises E by up to `epochs` passes over all of `train`, and ends after three passes without a
/// better loss. Held-out losses choose kappa and the iterate to keep. Where there are no held-out
/// paths, kappa is 0 and training losses choose. Without borrowing and epochs the result is
/// Gamma^full with its uniform part [Su22 eq 13]. Throws InterruptedError once `cancel` is set.
GammaResult optimiseGamma(const GammaData& train, const GammaData& heldOut, const FullGamma& full,
                          const GammaSettings& settings, const ThreadPool& pool,
                          const std::atomic<bool>& cancel);

}  // namespace lacuna

// Importance records: points on surfaces, from eye subpaths that add nothing to the image
// [Georgiev12]. Light vertices are weighed there by the four distributions of the comparison in
// [Noel15 5]. icbpt is made of them. (theory.md, "Importance records")
//
//   records   are cache points (cache_points.h), traced at the end of the iteration before
//   pmfs      over L_s, per record c and s:  F ∝ w_F = beta rho rho_c G V (full contribution),
//             U the same without V, B the same without V and rho_c and with G bounded by what it is
//             at four times the distance to the records around, C = 1 / |L_s|
//             combined by the maximum heuristic, one of them chosen evenly (length_pmfs.h)
//   pick      y from one of the records that serve z, evenly:  contribution h(y) / (M Pbar(y)),
//             Pbar = mean of P_c(y) over the records
//   weights   r = mean over the records of [1/M + (1 - 1/M) / (N R_c)]^-1,
//             R_c = max over the four of (w/Q) / Z, after [Nabata20a eq 14]. R_c is M P_c(y) for
//             frozen means per record and s, from the iteration before: Q = (1/M) sum of w, Z the
//             sum of maxima. V = 1, and rho is that at the eye vertex
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/resampling/cache_points.h"
#include "libcore/resampling/length_pmfs.h"

namespace lacuna {

class ImportanceRecords {
  public:
    enum Distribution : std::uint32_t { kFull, kUnoccluded, kBounded, kUniform, kDistributions };

    struct Options {
        std::uint64_t subpaths = 1024;  ///< M
        double density = 0.001;         ///< eye subpaths that leave records, per pixel
        int records = 3;                ///< that serve an eye vertex, N_c
        bool aware = true;              ///< whether weights will ask samplesOf()
    };

    /// The first iteration leaves records, the second finds their sums.
    static constexpr int kWarmupIterations = 2;

    explicit ImportanceRecords(const Options& options);

    /// The record that serves an eye vertex, which is also the vertex's label; kNone in the first
    /// iteration. `label` is the vertex's, or kNone where it is not known.
    std::uint32_t serving(const PathVertex& eye, Label label) const {
        return points_.serving(eye, label);
    }
    void labelAsEye(std::span<PathVertex> walk) const { points_.labelAsEye(walk); }
    /// Effective samples of `picks` picks of the connection's length. The record `serving` serves
    /// its eye vertex; for kNone the result is `picks`. Frozen for the iteration.
    double samplesOf(const Connection& connection, std::uint32_t serving, double picks) const;

    /// Makes this iteration's pmfs, one per record and s. `vertices` must outlive the iteration.
    void prepare(const VerticesByLength& vertices, IterationContext& context);
    struct Pick {
        std::size_t place;    ///< in `vertices`
        double probability;   ///< Pbar
        std::uint32_t label;  ///< a Distribution; kDistributions where there is no record
    };
    /// Picks a vertex of length s, u in [0, 1), for an eye vertex that the record `serving` serves.
    /// Without a record (kNone) it picks evenly.
    Pick pick(std::uint32_t serving, int s, double u, Rng& rng) const;
    /// Makes the next iteration's records, which read this iteration's sums.
    void observe(IterationContext& context);

  private:
    /// Fills the four weights of all vertices at the record. `weight` must hold zeros.
    void weigh(std::uint32_t record, const PathSpace& space, RayTally& tally,
               std::vector<double> (&weight)[kDistributions]) const;

    Options options_;
    CachePoints points_;          // of this iteration
    std::vector<double> learnt_;  // by record, length and column, from the earlier iteration
    EarlierValues earlier_;
    const VerticesByLength* vertices_ = nullptr;
    std::vector<CombinedPmf> pmfs_;  // by record and s
    std::vector<double> found_;      // as learnt_, of this iteration
};

}  // namespace lacuna

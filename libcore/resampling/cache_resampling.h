// Light vertices resampled at cache points: what pcbpt and risbpt have in common. They differ in
// what the weights believe. (theory.md, "risbpt")
//
//   Y         all connectable vertices of M light subpaths, new in every iteration; |Y| now
//   P_c       at each cache point c: pmf over Y, proportional to the target q*(y, c) = beta rho G V
//   pick      N per eye vertex z, each from one of the N_c cache points around z or from the
//             virtual one, which is uniform; divided by the probability of the mixture,
//                 h(y) / (M N Pbar(y)),   Pbar = (sum_c P_c + 1/|Y|) / (n' + 1),
//             over the n' points whose pmf is not empty       (theory.md, "Cache points")
//   Q(c)      (1/M) sum over Y of q*(y, c); an iteration's weights see the mean Q of the
//             earlier ones at the new cache points (as printed: of the one before). Q of Y
//             itself (risbpt-current) makes w depend on what it weighs: E[w h] is not E[w] h
//   MIS       plain: r = 1 [Popov15]; ris: the mean over the N_c + 1 choices of
//                 [ 1/M + (1/N) (1 - 1/M) p/q ]^-1,   p/q = max(clamp, Q(c) / q*(y, z)),
//             with V = 1, and N M / Vbar for the virtual point     [Nabata20a eq 14 and 5.2]
//             where Q(c) = 0 nothing can be picked at c: its term is 0;
//             then withEyeShare (as printed: no share)
#pragma once

#include <memory>

#include "libcore/resampling/cache_pmfs.h"
#include "libcore/resampling/merge_options.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

struct CacheResamplingOptions {
    enum class Weights { Ris, Plain };

    std::uint64_t subpaths = 100;  ///< M
    PickOptions picks = {.connections = 1, .first = 4};
    double cacheDensity = 0.004;  ///< eye subpaths that leave cache points, per pixel
    int cachePoints = 3;          ///< N_c
    CacheTarget target = CacheTarget::Flow;
    bool nextEvent = true;
    Lamps lamps = Lamps::Seen;
    MergeOptions merging = {};
    Weights weights = Weights::Plain;  ///< the options below are read where they are Ris
    int earlierIterations = 16;        ///< whose Q are averaged
    double clamp = 1e-3;
    double eyeShare = 0.1;
    bool currentQ = false;  ///< biased: Q of the current pool at each point
};

std::unique_ptr<Method> makeCacheResampling(const CacheResamplingOptions& options);

/// The options that all these rows have.
OptionTable<CacheResamplingOptions> cacheResamplingOptions(const CacheResamplingOptions& defaults);
/// Likewise, with the options of weights that are aware of the resampling.
OptionTable<CacheResamplingOptions> awareResamplingOptions(const CacheResamplingOptions& defaults);

/// `cache_density` and `cache_points`, of every row with cache points.
template <class Record, class Density, class Points>
void addCachePoints(OptionTable<Record>& table, Density density, Points points) {
    table.real("cache_density", density, 0, 16, "eye subpaths per pixel",
               "that leave cache points");
    table.integer("cache_points", points, 1, 16, "cache points", "that serve an eye vertex, N_c");
}
/// `clamp`, of every density that reads Q at cache points.
template <class Record, class Field>
void addClamp(OptionTable<Record>& table, Field field) {
    table.real("clamp", field, 0, 1, "", "lower limit of p/q in the weights");
}
/// `q_iterations`, of every row whose Q comes from earlier iterations.
template <class Record, class Field>
void addEarlierIterations(OptionTable<Record>& table, Field iterations) {
    table.integer("q_iterations", iterations, 1, 256, "earlier iterations",
                  "whose Q are averaged; the paper: 1");
}

/// N_q: cache points of an earlier iteration whose Q a new point reads [Nabata20a 5.2].
inline constexpr int kEarlierPoints = 3;

}  // namespace lacuna

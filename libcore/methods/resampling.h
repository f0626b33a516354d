// Light vertices resampled at cache points: what pcbpt and risbpt have in common. They differ in
// what the weights believe.
//
//   Y         all connectable vertices of M light subpaths, new in every iteration; |Y| now
//   P_c       at each cache point c: pmf over Y, proportional to the target q*(y, c) = beta rho G V
//   pick      N per eye vertex z, each from one of the N_c cache points around z or from the
//             virtual one, which is uniform; divided by the probability of the mixture,
//                 h(y) / (M N Pbar(y)),   Pbar = (sum_c P_c + 1/|Y|) / (n' + 1),
//             over the n' points whose pmf is not empty                            (methods.md 2)
//   Q(c)      (1/M) sum over Y of q*(y, c); an iteration's weights see the mean Q of the
//             earlier ones at the new cache points (as printed: of the one before). Read off Y
//             itself (risbpt-current) it makes w depend on what it weighs: E[w h] is not E[w] h
//   MIS       plain: r = 1 [Popov15]; ris: the mean over the N_c + 1 choices of
//                 [ 1/M + (1/N) (1 - 1/M) p/q ]^-1,   p/q = max(clamp, Q(c) / q*(y, z)),
//             with V = 1, and N M / Vbar for the virtual point     [Nabata20a eq 14 and 5.2]
//             where Q(c) = 0 nothing can be picked at c: its term is 0;
//             then withEyeShare (as printed: no share)
#pragma once

#include <memory>

#include "libcore/methods/cache_pmfs.h"
#include "libcore/methods/methods.h"

namespace lacuna {

struct ResamplingOptions {
    std::uint64_t subpaths;  ///< M
    Picks picks;             ///< N
    double cacheDensity;     ///< eye subpaths that leave cache points, per pixel
    int cachePoints;         ///< N_c
    CacheTarget target;
    double untested;  ///< removeHidden
    bool nextEvent = false;
    bool aware = false;  ///< ris weights; the rest is read by them alone
    int qPoints = 3;     ///< N_q
    int qSets = 1;       ///< earlier iterations whose Q are averaged
    double clamp = 1e-3;
    double eyeShare = 0.0;
    bool currentQ = false;  ///< biased: Q of the current pool at each point
};

std::unique_ptr<Method> makeResampling(const ResamplingOptions& options);

/// The parameters that both rows have.
std::vector<Parameter> resamplingParameters(double candidates, CacheTarget target);
/// Their values.
ResamplingOptions resamplingOptions(const Settings& settings);

}  // namespace lacuna

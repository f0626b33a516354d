#include "libcore/bidir/mis.h"

#include <algorithm>
#include <array>

namespace lacuna {

namespace {

/// The part of effectiveCount that reads more than two flags.
double samplesByDensity(const FullPath& path, const TechniqueCounts& counts, int t) {
    const auto s = std::size_t(path.edges + 1 - t);
    const double samples = counts.connections->effectiveSamples(
        {.eye = {path.vertex[s], path.vertex[s + 1], t, path.scatter[s], path.asEye[s]},
         .light = {path.vertex[s - 1], s >= 2 ? path.vertex[s - 2] : nullptr, int(s),
                   path.scatter[s - 1], path.asLight[s - 1]},
         .beta = path.beta[s - 1],
         .geometry = path.geometry[s - 1],
         .order = path.orderOf(int(s))});
    return s == 1 ? samples * counts.samplesOfLamp(*path.vertex[0], *path.vertex[1]) : samples;
}

/// effectiveCount() where it depends on nothing but the kind of strategy.
class CountsByKind {
  public:
    CountsByKind(const FullPath& path, const TechniqueCounts& counts) : path_(path) {
        const auto constants = counts.constants.value_or(ConnectionDensity::Constants{});
        double direct = constants.direct;
        if (direct > 0.0 && path.edges > 1 && !path.delta[1]) {
            direct *= counts.samplesOfLamp(*path.vertex[0], *path.vertex[1]);
        }
        counts_ = {0.0, constants.indirect, direct,
                   path.edges == 1 && !path.splattable ? 0.0 : counts.splats,
                   counts.hit && path.hittable ? 1.0 : 0.0};
    }

    // Selections, not branches: no predictor could know which strategy is asked for.
    double operator()(int t) const {
        const int s = path_.edges + 1 - t;
        int kind = s == 1 ? kDirect : kIndirect;
        kind = t == 1 ? kSplat : kind;
        kind = int(path_.delta[std::max(0, s - 1)]) | int(path_.delta[s]) ? kNone : kind;
        kind = s == 0 ? kHit : kind;
        return counts_[kind];
    }

  private:
    enum Kind { kNone, kIndirect, kDirect, kSplat, kHit };
    const FullPath& path_;
    std::array<double, 5> counts_;
};

}  // namespace

double effectiveCount(const FullPath& path, const TechniqueCounts& counts, int t) {
    const bool connects = t >= 2 && t <= path.edges;
    if (!connects || !counts.connections || counts.constants) {
        return CountsByKind(path, counts)(t);
    }
    return path.exists(t) ? samplesByDensity(path, counts, t) : 0.0;
}

namespace {

/// The balance heuristic, with n r of each strategy by `countOf`.
template <class CountOf>
double sweep(const FullPath& path, const TechniqueCounts& counts, int t, const CountOf& countOf) {
    const int k = path.edges;
    const double own = countOf(t);
    if (own <= 0.0) return 0.0;
    double sum = own;

    // Towards the light: the eye takes over x_{k-t}, x_{k-t-1}, .. x_0.
    const int rouletteDepth = counts.rouletteDepth;
    double ratio = 1.0;
    for (int i = k - t; i >= 0; --i) {
        ratio *= path.eyePdfA[i] * path.eyeRoulette(i, rouletteDepth) /
                 (path.lightPdfA[i] * path.lightRoulette(i, rouletteDepth));
        if (!(ratio > 0.0)) break;  // all further strategies hold this zero as well
        sum += ratio * countOf(k - i + 1);
    }
    // Towards the lens: light takes over x_{k-t+1} .. x_{k-1}, or x_0 at most.
    const int last = counts.onlyDirect() ? 0 : k - 1;
    ratio = 1.0;
    for (int i = k - t + 1; i <= last; ++i) {
        ratio *= path.lightPdfA[i] * path.lightRoulette(i, rouletteDepth) /
                 (path.eyePdfA[i] * path.eyeRoulette(i, rouletteDepth));
        if (!(ratio > 0.0)) break;
        sum += ratio * countOf(k - i);
    }
    return own / sum;
}

}  // namespace

double misWeight(FullPath& path, const TechniqueCounts& counts, int t) {
    if (!counts.connections || counts.constants) {
        return sweep(path, counts, t, CountsByKind(path, counts));
    }
    path.fillLightThroughputs(counts.rouletteDepth);
    return sweep(path, counts, t,
                 [&](int strategy) { return effectiveCount(path, counts, strategy); });
}

}  // namespace lacuna

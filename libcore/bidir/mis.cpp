#include "libcore/bidir/mis.h"

#include <algorithm>
#include <array>

#include "libcore/bidir/absorption.h"

namespace lacuna {

double FullPath::geometryOf(int i) const {
    // The end that knows the edge as its way back: the farther one of its own walk.
    const PathVertex* end = i < lightEdges          ? vertex[i + 1]
                            : i >= edges - eyeEdges ? vertex[i]
                                                    : nullptr;
    return end ? measureCosine(*end, end->toPrevious) * double(end->toPreviousFactor)
               : double(edgeBetween(*vertex[i], *vertex[i + 1]).geometry);
}

Vec3 FullPath::directionOf(int i) const {
    if (i < lightEdges) return -vertex[i + 1]->toPrevious;
    if (i >= edges - eyeEdges) return vertex[i]->toPrevious;
    return edgeBetween(*vertex[i], *vertex[i + 1]).direction;
}

void FullPath::fillLightThroughputs(int rouletteDepth) {
    beta[0] = sourceBeta;
    for (int i = 1; i < edges; ++i) {
        // beta_i = beta_{i-1} f G / p(x_i): both steps of the measure in double.
        const double g = geometry[i - 1] = geometryOf(i - 1);
        const double pdf = double(lightPdfA[i]) * lightRoulette(i, rouletteDepth);
        beta[i] = pdf > 0.0 ? beta[i - 1] * scatter[i - 1] * float(g / pdf) : Rgb{};
        if (!absorption.empty()) {
            beta[i] *= transmittance(absorption, *vertex[i - 1], directionOf(i - 1), *vertex[i]);
        }
    }
}

namespace {

/// The part of effectiveCount that reads more than two flags.
double samplesByDensity(const FullPath& path, const Techniques& techniques, int t) {
    const int s = path.edges + 1 - t;
    return techniques.connections->effectiveSamples(
        {.eye = {path.vertex[s], path.vertex[s + 1], t, path.scatter[s], path.makerOf(s),
                 path.across.light},
         .light = {path.vertex[s - 1], s >= 2 ? path.vertex[s - 2] : nullptr, s,
                   path.scatter[s - 1], s >= 2 ? path.makerOf(s - 2) : EdgeMaker::Connection,
                   s >= 2 ? path.across.eye : kNone},
         .beta = path.beta[s - 1],
         .geometry = path.geometry[s - 1],
         .order = path.orderOf(s)});
}

/// effectiveCount() where it depends on nothing but the kind of strategy.
class CountsByKind {
  public:
    CountsByKind(const FullPath& path, const Techniques& techniques) : path_(path) {
        const auto constants = techniques.constants.value_or(ConnectionDensity::Constants{});
        counts_ = {0.0, constants.indirect, constants.direct,
                   path.edges == 1 && !path.splattable ? 0.0 : techniques.splats,
                   techniques.hit && path.hittable ? 1.0 : 0.0};
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

double effectiveCount(const FullPath& path, const Techniques& techniques, int t) {
    const bool connects = t >= 2 && t <= path.edges;
    if (!connects || !techniques.connections || techniques.constants) {
        return CountsByKind(path, techniques)(t);
    }
    return path.exists(t) ? samplesByDensity(path, techniques, t) : 0.0;
}

namespace {

/// The balance heuristic, with n r of each strategy by `counts`.
template <class Counts>
double sweep(const FullPath& path, const Techniques& techniques, int t, const Counts& counts) {
    const int k = path.edges;
    const double own = counts(t);
    if (own <= 0.0) return 0.0;
    double sum = own;

    // Towards the light: the eye takes over x_{k-t}, x_{k-t-1}, .. x_0.
    const int rouletteDepth = techniques.rouletteDepth;
    double ratio = 1.0;
    for (int i = k - t; i >= 0; --i) {
        ratio *= path.eyePdfA[i] * path.eyeRoulette(i, rouletteDepth) /
                 (path.lightPdfA[i] * path.lightRoulette(i, rouletteDepth));
        if (!(ratio > 0.0)) break;  // all further strategies hold this zero as well
        sum += ratio * counts(k - i + 1);
    }
    // Towards the lens: light takes over x_{k-t+1} .. x_{k-1}, or x_0 at most.
    const int last = techniques.onlyDirect() ? 0 : k - 1;
    ratio = 1.0;
    for (int i = k - t + 1; i <= last; ++i) {
        ratio *= path.lightPdfA[i] * path.lightRoulette(i, rouletteDepth) /
                 (path.eyePdfA[i] * path.eyeRoulette(i, rouletteDepth));
        if (!(ratio > 0.0)) break;
        sum += ratio * counts(k - i);
    }
    return own / sum;
}

}  // namespace

double misWeight(FullPath& path, const Techniques& techniques, int t) {
    if (!techniques.connections || techniques.constants) {
        return sweep(path, techniques, t, CountsByKind(path, techniques));
    }
    path.fillLightThroughputs(techniques.rouletteDepth);
    return sweep(path, techniques, t,
                 [&](int strategy) { return effectiveCount(path, techniques, strategy); });
}

}  // namespace lacuna

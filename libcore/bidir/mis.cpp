// (theory.md, "Weights", "Merging")
#include "libcore/bidir/mis.h"

#include <algorithm>
#include <array>

namespace lacuna {

namespace {

/// n r of strategy t by a density that has no constants.
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

/// n r of a strategy, if it depends on nothing but the strategy's kind.
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

/// The factor that n r of a strategy is still to be multiplied by, because pixels share
/// the eye's walk.
class SamplesByShare {
  public:
    SamplesByShare(const FullPath& path, const Sharing& sharing)
        : edge_(sharing.any() ? sharedEdge(path) : 0), k_(path.edges) {}

    double operator()(int t) const { return k_ + 1 - t < edge_ ? kSharedSamples : 1.0; }

  private:
    int edge_, k_;
};

/// n r of strategy t, if pixels share no walks.
double countAlone(const FullPath& path, const TechniqueCounts& counts, int t) {
    const bool connects = t >= 2 && t <= path.edges;
    if (!connects || !counts.connections || counts.constants) {
        return CountsByKind(path, counts)(t);
    }
    return path.exists(t) ? samplesByDensity(path, counts, t) : 0.0;
}

}  // namespace

double effectiveCount(const FullPath& path, const TechniqueCounts& counts, int t) {
    return countAlone(path, counts, t) * SamplesByShare(path, counts.sharing)(t);
}

double refractedSamples(const FullPath& path, const TechniqueCounts& counts) {
    if (path.refracted.ratio == 0.0) return 0.0;
    double survival = 1.0;
    for (int i = 0; i <= path.refracted.vertices; ++i) {
        survival *= path.eyeRoulette(i, counts.rouletteDepth);
    }
    return path.refracted.ratio / survival;
}

namespace {

/// Whether b = 2.
bool squaresSamples(const FullPath& path, const TechniqueCounts& counts) {
    const bool squared = counts.squared == SquaredLights::All ||
                         (counts.squared == SquaredLights::Hittable && path.hittable);
    return squared && path.isDirectLight();
}

/// Weight by the balance heuristic or the power heuristic, with n r of each strategy by `countOf`, and with merges or
/// without any.
template <bool kMerges, class CountOf>
double sweep(const FullPath& path, const TechniqueCounts& counts, Technique made,
             const CountOf& countOf) {
    const int k = path.edges;
    // Ratios are relative to p_t. For a merge at x_i this is the strategy whose light part
    // ends with x_i.
    const int t = made.refracts() ? k + 1 : made.merges() ? made.t - 1 : made.t;
    const int rouletteDepth = counts.rouletteDepth;
    const auto lightPdf = [&](int i) {
        return path.lightPdfA[i] * path.lightRoulette(i, rouletteDepth);
    };
    const auto eyePdf = [&](int i) { return path.eyePdfA[i] * path.eyeRoulette(i, rouletteDepth); };
    const bool squares = squaresSamples(path, counts);
    const auto term = [squares](double samples) { return squares ? samples * samples : samples; };
    const double refracted = refractedSamples(path, counts);
    const double ofStrategy = countOf(t);
    const double own = made.merges()     ? mergedSamples(path, counts, k - t) * eyePdf(k - t)
                       : made.refracts() ? refracted
                                         : ofStrategy;
    if (own <= 0.0) return 0.0;
    double sum = term(ofStrategy);

    // Towards the light: the eye takes over x_{k-t}, x_{k-t-1}, .. x_0. Where both walks make x_i, the two are merged.
    double ratio = 1.0;
    for (int i = k - t; i >= 0; --i) {
        const double eye = eyePdf(i);
        if (kMerges && i > 0) sum += term(ratio * eye * mergedSamples(path, counts, i));
        ratio *= eye / lightPdf(i);
        if (!(ratio > 0.0)) break;  // all further strategies have this zero as a factor
        sum += term(ratio * countOf(k - i + 1));
    }
    if (refracted > 0.0 && ratio > 0.0) sum += term(ratio * refracted);  // beside s = 0
    // Towards the lens: light takes over x_{k-t+1} .. x_{k-1}, or x_0 at most.
    const int last = counts.onlyDirect() ? 0 : k - 1;
    ratio = 1.0;
    for (int i = k - t + 1; i <= last; ++i) {
        const double light = lightPdf(i);
        if (kMerges && i > 0) sum += term(ratio * light * mergedSamples(path, counts, i));
        ratio *= light / eyePdf(i);
        if (!(ratio > 0.0)) break;
        sum += term(ratio * countOf(k - i));
    }
    return term(own) / sum;
}

template <class CountOf>
double weightBy(const FullPath& path, const TechniqueCounts& counts, Technique made,
                const CountOf& countAlone) {
    const SamplesByShare share(path, counts.sharing);
    const auto countOf = [&](int t) { return countAlone(t) * share(t); };
    return counts.merges == Merges::Nowhere ? sweep<false>(path, counts, made, countOf)
                                            : sweep<true>(path, counts, made, countOf);
}

}  // namespace

double misWeight(FullPath& path, const TechniqueCounts& counts, Technique made) {
    if (made.chains()) return 1.0;
    if (!counts.connections || counts.constants) {
        return weightBy(path, counts, made, CountsByKind(path, counts));
    }
    path.fillLightThroughputs(counts.rouletteDepth);
    return weightBy(path, counts, made,
                    [&](int strategy) { return countAlone(path, counts, strategy); });
}

}  // namespace lacuna

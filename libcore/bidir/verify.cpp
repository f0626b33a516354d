// (theory.md, "Weights")
#include "libcore/bidir/verify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "libcore/bidir/absorption.h"
#include "libcore/bidir/known_ways.h"

namespace lacuna {

namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();  // log of a zero density

double logOf(double density) {
    return density == 0.0 ? kNever : std::log(density);
}

/// Densities of one full path, computed anew. Vertices are x_0 (light) .. x_k (lens). `made` is the
/// technique that made the path.
class Products {
  public:
    Products(const Walker& walker, const FullPath& path, const TechniqueCounts& counts,
             Technique made)
        : walker_(walker),
          path_(path),
          counts_(counts),
          k_(path.edges),
          made_(made),
          split_(made.firstOfEye(path.edges)),
          lights_(walker.lights()),
          source_(lightPointOf(lights_, *path.vertex[0])) {
        for (int i = 0; i < k_; ++i) setEdge(i);
        setLightSource();
        for (int i = 1; i < k_; ++i) setScatter(i);
        setLens();
        eyePdfA_[0] *= double(source_.opacity);  // eye walks find a lamp with alpha that often
        if (counts_.connections && !counts_.connections->constants()) setThroughputs();
    }

    double weight() const {
        // A specular chain has no density. Its weight is one if nothing else makes the path.
        const double refracted = logRefraction();
        const double own = made_.chains()     ? 0.0
                           : made_.merges()   ? logMerge(split_)
                           : made_.refracts() ? refracted
                                              : logTerm(made_.t);
        if (own == kNever) return 0.0;
        const double power = squares() ? 2.0 : 1.0;
        const auto relative = [&](double term) { return std::exp(power * (term - own)); };
        double sum = (made_.chains() ? 1.0 : 0.0) + relative(refracted);
        for (int i = 1; i <= k_ + 1; ++i) sum += relative(logTerm(i));
        for (int i = 1; i < k_; ++i) sum += relative(logMerge(i));
        return 1.0 / sum;
    }

  private:
    const PathVertex& x(int i) const { return *path_.vertex[std::size_t(i)]; }
    /// x_{i+1} as the end of the edge from x_i. A merged vertex has two places: that of the
    /// light's walk (the photon), where this edge ends, and that of the eye's walk, which is
    /// used for all else.
    const PathVertex& endOfEdge(int i) const {
        return made_.merges() && i + 1 == split_ ? *path_.photon : x(i + 1);
    }
    /// Towards the lens, from x_i to x_{i+1}.
    Vec3 towardsLens(int i) const { return direction_[std::size_t(i)]; }

    /// Sets edge x_i -> x_{i+1}: the direction that its walk had, and the factors that turn a
    /// density per solid angle at one end into the measure of the other.
    void setEdge(int i) {
        const PathVertex &a = x(i), &b = endOfEdge(i);
        const auto e = std::size_t(i);
        if (i + 1 < split_ + int(made_.merges())) {
            direction_[e] = -b.toPrevious;  // light walk: b's previous is a
        } else if (i >= split_) {
            direction_[e] = a.toPrevious;  // eye walk: a's previous is b
        } else {
            direction_[e] = edgeBetween(a, b).direction;
        }
        const auto cosine = [&](const PathVertex& v) {
            return v.ng == Vec3{} ? 1.0 : std::fabs(dot(Vec3d(v.ng), Vec3d(direction_[e])));
        };
        if (a.infinite()) {  // x_0 only: its measure is solid angle, and no distance is divided by
            toLens_[e] = cosine(b);
            toLight_[e] = 1.0;
            geometry_[e] = cosine(b);
            return;
        }
        const double squared = lengthSquared(Vec3d(b.position) - Vec3d(a.position));
        // Vertices of a chain may coincide, at the edge of a body. No strategy joins them, so any distance will do: it
        // is a factor of all densities.
        const double inverse2 = squared > 0.0 ? 1.0 / squared : 1.0;
        toLens_[e] = cosine(b) * inverse2;
        toLight_[e] = cosine(a) * inverse2;
        geometry_[e] = cosine(a) * cosine(b) * inverse2;
    }

    /// Sets p(x_0) and p(x_1 | x_0).
    void setLightSource() {
        const Lights::Emission emission =
            lights_.emission(source_, towardsLens(0), endOfEdge(0).position);
        lightPdfA_[0] = double(source_.pdf);
        if (k_ > 1) lightPdfA_[1] = double(emission.pdfW) * toLens_[0];
        scatter_[0] = Rgb(emission.profile);
        event_[0] = ScatterEvent::Smooth;
    }

    /// Sets what scattering at x_i gives: the eye walk's density of x_{i-1} and the light walk's of
    /// x_{i+1}. A connection's two ends and a merged vertex scatter smoothly. At other vertices the
    /// event is the walk's.
    void setScatter(int i) {
        const auto v = std::size_t(i);
        const bool connects = made_.by == Technique::By::Strategy;
        const bool end = i == split_ || (connects && i == split_ - 1);
        event_[v] = end ? ScatterEvent::Smooth : x(i).event;
        BsdfEvaluation e = x(i).bsdf.evaluate(towardsLens(i), -towardsLens(i - 1), event_[v]);
        if (const WalkGuide* guide = walker_.guide(); guide && x(i).connectable()) {
            guide->mix(guide->regionAt(WalkGuide::placeOf(x(i))), towardsLens(i),
                       -towardsLens(i - 1), event_[v], e);
        }
        scatter_[v] = e.f;
        survival_[v] = double(x(i).bsdf.survivalAlbedo());
        eyePdfA_[v - 1] = double(e.pdfWToLight) * toLight_[v - 1];
        if (i + 1 < k_) lightPdfA_[v + 1] = double(e.pdfWToEye) * toLens_[v];
    }

    /// Sets p(x_{k-1} | x_k). The lens itself has the same density in every strategy: it cancels.
    void setLens() {
        const Camera& camera = walker_.camera();
        const Vec3 lens = x(k_).position, direction = -towardsLens(k_ - 1);
        const auto projection = camera.project(lens, direction);
        double pdfW = 0.0;
        if (projection) {
            pdfW = projection->pdfW;
        } else if (const float cosine = dot(direction, camera.forward()); cosine > 0.0f) {
            // On the film's very edge rounding may put the raster position outside. The density
            // then follows from that at the film's middle, by 1 / cos^3.
            const Camera::Film film = camera.film();
            const Camera::Direction middle = camera.directionAt(
                camera.position(), {0.5f * float(film.width), 0.5f * float(film.height)});
            const double ratio = double(dot(middle.direction, camera.forward())) / double(cosine);
            pdfW = double(middle.pdfW) * ratio * ratio * ratio;
        }
        eyePdfA_[std::size_t(k_) - 1] = pdfW * toLight_[std::size_t(k_) - 1];
    }

    /// Probability that roulette lets a walk reach x_i: the survival at its predecessor, if the
    /// predecessor's index in the walk is high enough.
    double lightRoulette(int i) const {
        const int at = i - 1;
        return at >= 1 && at >= counts_.rouletteDepth ? survival_[std::size_t(at)] : 1.0;
    }
    double eyeRoulette(int i) const {
        const int at = i + 1;
        return at <= k_ - 1 && k_ - at >= counts_.rouletteDepth ? survival_[std::size_t(at)] : 1.0;
    }

    /// Sets beta at every x_i. The throughput of a punctual light is taken from the path, because
    /// it is no density. The light's probability is not.
    void setThroughputs() {
        const bool known =
            source_.kind == LightKind::Area || source_.kind == LightKind::Environment;
        beta_[0] = known ? source_.throughput() : path_.sourceBeta;
        for (int i = 1; i < k_; ++i) {
            const auto v = std::size_t(i);
            const double pdf = lightPdfA_[v] * lightRoulette(i);
            beta_[v] =
                pdf > 0.0 ? beta_[v - 1] * scatter_[v - 1] * float(geometry_[v - 1] / pdf) : Rgb{};
            beta_[v] *= transmittance(walker_.scene().absorption(), x(i - 1), towardsLens(i - 1),
                                      endOfEdge(i - 1));
        }
    }

    bool smooth(int i) const { return !isDelta(event_[std::size_t(i)]); }
    /// Whether b = 2.
    bool squares() const {
        if (counts_.squared == SquaredLights::None) return false;
        if (counts_.squared == SquaredLights::Hittable && !isHittable(source_.kind)) return false;
        return isSeenNearlySpecularly(1);
    }
    bool isSeenNearlySpecularly(int i) const {
        for (int j = i + 1; j < k_; ++j) {
            if (smooth(j) && !x(j).bsdf.isNarrow()) return false;
        }
        return true;
    }
    /// Connection::order of x_i.
    int orderOf(int i) const {
        int order = 1;
        for (int j = i + 1; j < k_; ++j) order += smooth(j);
        return order;
    }

    /// n_t r_t, from events and vertices.
    double count(int t) const {
        const int s = k_ + 1 - t;
        if (s == 0) return counts_.hit && isHittable(source_.kind) ? 1.0 : 0.0;
        if (s >= 2 && !smooth(s - 1)) return 0.0;
        if (t >= 2 && !smooth(s)) return 0.0;
        if (t == 1) {
            // A punctual light seen directly has no size in the picture.
            return k_ == 1 && !isHittable(source_.kind) ? 0.0 : counts_.splats;
        }
        if (!counts_.connections) return 0.0;
        const double ofLamp = s == 1 ? counts_.samplesOfLamp(x(0), x(1)) : 1.0;
        if (const auto c = counts_.connections->constants()) {
            return s == 1 ? c->direct * ofLamp : c->indirect;
        }
        const auto v = std::size_t(s);
        return ofLamp * counts_.connections->effectiveSamples(
                            {.eye = {&x(s), &x(s + 1), t, scatter_[v]},
                             .light = {&x(s - 1), s >= 2 ? &x(s - 2) : nullptr, s, scatter_[v - 1]},
                             .beta = beta_[v - 1],
                             .geometry = geometry_[v - 1],
                             .order = orderOf(s)});
    }

    /// The factor of n r of strategy t if its eye walk makes the edge that pixels share: the first one from a vertex
    /// that scatters smoothly.
    double share(int t) const {
        if (!counts_.sharing.any()) return 1.0;
        int i = k_ - 1;
        while (i > 1 && !smooth(i)) --i;
        const bool isThere =
            i > 1 && smooth(i) && smooth(i - 1) && forks(x(i)) && mayBeShared(x(i - 1));
        const bool isOfTheEye = t >= k_ + 2 - i;
        return isThere && isOfTheEye ? kSharedSamples : 1.0;
    }

    /// log(n_t r_t p_t).
    double logTerm(int t) const {
        const int s = k_ + 1 - t;
        return logOf(count(t)) + logOf(share(t)) + logDensities(s, s);
    }
    /// Log of the density of the light's walk over its first `byLight` vertices, and of the eye's
    /// walk from x_first on.
    double logDensities(int byLight, int first) const {
        double sum = 0.0;
        for (int i = 0; i < byLight; ++i) {
            sum += logOf(lightPdfA_[std::size_t(i)]) + logOf(lightRoulette(i));
        }
        for (int i = first; i < k_; ++i) {
            sum += logOf(eyePdfA_[std::size_t(i)]) + logOf(eyeRoulette(i));
        }
        return sum;
    }

    /// log p of next event through glass or along known ways: an eye walk's without roulette on the chain, times the
    /// ratio of the two.
    double logRefraction() const {
        RayTally ignored;
        const OverChain over = refractedRatioOf(path_, counts_, ignored, true);
        double sum = logOf(over.ratio) + logDensities(0, 0);
        for (int i = 0; i <= over.vertices; ++i) sum -= logOf(eyeRoulette(i));
        return sum;
    }

    /// log(n_m pi R^2 p) of the merge at x_i, which both walks make.
    double logMerge(int i) const {
        if (!merges(i)) return kNever;
        return logOf(counts_.mergeSamples) + logDensities(i + 1, i);
    }
    bool merges(int i) const {
        if (!smooth(i)) return false;
        switch (counts_.merges) {
            case Merges::Nowhere:
                return false;
            case Merges::Everywhere:
                return true;
            case Merges::FirstFromEye:
                return isSeenNearlySpecularly(i);
            case Merges::BetweenDeltas:
                return i > 1 && i < k_ - 1 && !smooth(i - 1) && !smooth(i + 1);
        }
        return false;
    }

    template <class T>
    using PerVertex = std::array<T, std::size_t(kMaxEdges) + 1>;

    const Walker& walker_;
    const FullPath& path_;
    const TechniqueCounts& counts_;
    const int k_;
    const Technique made_;
    const int split_;  // x_0 .. x_{split-1} were made by the light's walk; merges: x_split by both
    const Lights& lights_;
    const LightPoint source_;
    // Indexed by edge: edge i is that of x_i and x_{i+1}.
    PerVertex<Vec3> direction_;
    PerVertex<double> toLens_, toLight_, geometry_;
    // Indexed by vertex.
    PerVertex<double> lightPdfA_, eyePdfA_, survival_;
    PerVertex<Rgb> scatter_, beta_;
    PerVertex<ScatterEvent> event_;
};

}  // namespace

double misWeightByProducts(const Walker& walker, const FullPath& path,
                           const TechniqueCounts& counts, Technique made) {
    return Products(walker, path, counts, made).weight();
}

WeightVerifier::WeightVerifier(const Walker& walker, const ThreadPool& pool)
    : walker_(walker),
      pool_(pool),
      filmWidth_(walker.camera().film().width),
      slots_(std::size_t(pool.threads())) {}

bool WeightVerifier::Worst::worseThan(const Worst& other) const {
    if (difference != other.difference) return difference > other.difference;
    const Sample &a = sample, &b = other.sample;
    return std::tie(a.iteration, a.ofLight, a.number) < std::tie(b.iteration, b.ofLight, b.number);
}

void WeightVerifier::check(const PathEvent& event) {
    Slot& slot = slots_[std::size_t(pool_.workerIndex())];
    ++slot.paths;
    const double again = misWeightByProducts(walker_, event.path, event.counts, event.technique);
    double difference = std::fabs(again - event.weight);
    if (std::isnan(difference)) {
        ++slot.notNumbers;
        difference = 1.0;
    }
    const Worst worst{difference, event.sample};
    if (worst.worseThan(slot.worst)) slot.worst = worst;
}

WeightVerifier::Result WeightVerifier::result() const {
    Result result;
    Worst worst;
    for (const Slot& slot : slots_) {
        result.paths += slot.paths;
        result.notNumbers += slot.notNumbers;
        if (slot.worst.worseThan(worst)) worst = slot.worst;
    }
    if (result.paths == 0) return result;
    result.maxDifference = worst.difference;
    result.replay = worst.sample.address(filmWidth_);
    return result;
}

}  // namespace lacuna

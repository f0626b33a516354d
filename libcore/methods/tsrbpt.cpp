// Two-stage resampling [Nabata20b]: many light subpaths, thinned out at every cache point by a cut
// through a light tree before the costly target is evaluated. (theory.md, "tsrbpt")
//
//   Y         all connectable vertices of M1 light subpaths, new in every iteration; a light tree
//   stage 1   at each cache point c a cut of M2 clusters, bounded by power x G; from each cluster
//             one y_j by P1 = beta(y_j) / B_j, B_j the cluster's sum of beta        [eq 14]
//   stage 2   j by P2 = (1 - d) T_j / sum T + d U_j / sum U,
//             T_j = q2*(y_j, c) / P1 (target over proposal), q2* = beta rho G V; or, as printed,
//             T_j = q2* / q1*, q1* = beta G                                         [eq 16]
//             U_j = B_j / distance^2, positive for all (B_j for vertices at infinity, whose
//             beta is per area)
//   pick      N times: c uniform among the N_c cache points around z, j by P2:  h / (M1 N P1 P2)
//             (the printed 1 / (M1 M2) belongs to draws from one P1 over all of Y)
//   MIS       the mean over the N_c points of r_c =                                 [eq 17]
//                 [ 1/M1 + (1 - 1/M1) ( (1/M2) p/q1 + (1 - 1/M2) p/q2 / (N (1 - d)) ) ]^-1,
//             (as printed: N = 1, d = 0)
//             p/q1 = Q1(c) / q1*(y, z), p/q2 = Q2(c) / q2*(y, z), each at least `clamp`, V = 1;
//             Q1 = (1/M1) sum_j B_j G, Q2 = (1/M1) sum_j T_j of earlier iterations,
//             averaged (as printed: of the one before)
//             where Q2(c) = 0 only stage 1 helps: p/q1 takes the place of p/q2;
//             then withEyeShare (as printed: no share)
//   points    as printed [5.4]: N_c points and a virtual one that picks evenly from Y; one of them
//             is chosen with 1 / (N_c + 1), and the pick's weight is times (N_c + 1) a_c(y), where
//             a_c = r_c / (sum of all r), the virtual r = N M1 / Vbar, and r_c = 0 here where c
//             never picks y (d = 0: where T would be zero, which takes a ray for each point);
//             MIS: the mean of all N_c + 1
#include <algorithm>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "libcore/resampling/cache_points.h"
#include "libcore/resampling/cache_resampling.h"
#include "libcore/resampling/light_tree.h"
#include "libcore/resampling/merge_options.h"

namespace lacuna {

namespace {

constexpr std::size_t kPointsPerChunk = 32;

enum class Weights { Tsr, Ris, Plain };
enum class SecondStage { Energy, Printed };
enum class Points { Even, Weighted };

struct Options {
    std::uint64_t subpaths = 10'000;  ///< M1
    PickOptions picks = {.connections = 1, .first = 8};
    std::uint32_t clusters = 200;  ///< M2
    double cacheDensity = 0.004;
    int cachePoints = 1;  ///< N_c
    Points points = Points::Even;
    double defensive = 0.7;  ///< d
    SecondStage secondStage = SecondStage::Energy;
    Weights weights = Weights::Tsr;
    double clamp = 1e-3;
    int earlierIterations = 16;  ///< whose Q are averaged
    double eyeShare = 0.1;
    bool nextEvent = true;
    Lamps lamps = Lamps::Seen;
    MergeOptions merging = {};
};

class TwoStageDensity final : public ConnectionDensity {
  public:
    explicit TwoStageDensity(const Options& options)
        : options_(options), picks_(options.picks.picks()) {}

    void freeze(const CachePoints& points, std::span<const double> q, double expectedVertices) {
        points_ = &points;
        q_ = q;
        const auto m1 = double(options_.subpaths);
        uniform_ = m1 / expectedVertices;
    }

    Lamps lamps() const override { return lampsOf(options_.nextEvent, options_.lamps); }
    bool keepsLabels() const override { return true; }
    void labelWalk(std::span<PathVertex> walk) const override { points_->labelAsEye(walk); }

    double effectiveSamples(const Connection& c) const override {
        if (options_.nextEvent && c.light.count == 1) return 1.0;
        const double n = picks_.at(c.order);
        const auto around = points_->around(points_->serving(*c.eye.vertex, c.eye.label));
        if (around.empty()) return n * uniform_;
        const Offered y{c.light.vertex, double(mean(c.beta)),
                        double(mean(c.beta * c.light.scatter)), c.geometry};
        const bool virtualPoint = options_.points == Points::Weighted;
        double sum = virtualPoint ? n * uniform_ : 0.0;
        for (const std::uint32_t i : around) sum += samplesAt(i, y, n);
        return withEyeShare(sum / double(around.size() + (virtualPoint ? 1 : 0)), c.order,
                            options_.eyeShare);
    }

    /// A light vertex as an eye vertex sees it.
    struct Offered {
        const PathVertex* vertex;
        double power, flow;  ///< mean(beta), mean(beta rho) towards the eye vertex
        double geometry;     ///< G of the two
    };
    /// r_c of cache point `point`, with n picks; V = 1.
    double samplesAt(std::uint32_t point, const Offered& y, double n) const {
        if (!(y.power > 0.0) || !(y.flow > 0.0)) return 0.0;  // in no cluster, or nothing to carry
        const double g = points_->trustedGeometry(point, *y.vertex, y.geometry);
        const double q1 = q_[2 * point], q2 = q_[2 * point + 1];
        const double ratio1 = std::max(options_.clamp, q1 / (y.power * g));
        const double ratio2 = q2 > 0.0 ? std::max(options_.clamp, q2 / (y.flow * g)) : ratio1;
        return effective(ratio1, ratio2 / (n * (1.0 - options_.defensive)));
    }
    /// r of the virtual point, with n picks.
    double samplesOfVirtual(double n) const { return n * uniform_; }

  private:
    double effective(double ratio1, double ratio2) const {
        const double m1 = 1.0 / double(options_.subpaths), m2 = 1.0 / double(options_.clusters);
        if (options_.weights == Weights::Ris) return 1.0 / (m2 + (1.0 - m2) * ratio2);
        return 1.0 / (m1 + (1.0 - m1) * (m2 * ratio1 + (1.0 - m2) * ratio2));
    }

    Options options_;
    Picks picks_;
    const CachePoints* points_ = nullptr;
    std::span<const double> q_;  // Q1, Q2 by cache point
    double uniform_ = 1.0;
};

/// The light vertex that a cache point offers for one of its clusters, with the cdf of
/// P2 over these.
struct Offer {
    std::uint32_t candidate;
    double cdf;
    double scale;  ///< 1 / (M1 P1)
};

class TwoStageResampling final : public Method {
  public:
    explicit TwoStageResampling(const Options& options)
        : options_(options),
          picks_(options.picks.picks()),
          plain_(picks_, options.nextEvent, options.lamps, 1.0),
          density_(options),
          earlier_(2, options.earlierIterations, kEarlierPoints) {}

    // The first warm-up leaves cache points, the second finds their Q.
    int warmupIterations() const override { return 2; }
    PoolRequest pool() const override { return {options_.subpaths}; }
    Merging merging() const override { return options_.merging.merging(); }
    bool learns() const override { return true; }

    const ConnectionDensity& freeze(std::uint32_t) override {
        density_.freeze(points_, q_, expected_.value());
        if (options_.weights == Weights::Plain) return plain_;
        return density_;
    }

    void prepare(const LightPool& pool, IterationContext& context) override {
        pool_ = &pool;
        takePickable(pool, !options_.nextEvent, candidates_);
        {
            PhaseTimer timer(context.statistics, "light tree");
            tree_ = LightTree(pool, candidates_, context.threads);
        }
        PhaseTimer timer(context.statistics, "cuts and pmfs");
        perPoint_ = tree_.size() == 0 ? 0 : std::max<std::size_t>(2, options_.clusters);
        offers_.resize(points_.size() * perPoint_);
        offered_.assign(points_.size(), 0);
        sums_.assign(2 * points_.size(), 0.0);
        if (perPoint_ == 0) return;
        std::vector<RayTally> tallies((points_.size() + kPointsPerChunk - 1) / kPointsPerChunk);
        context.threads.forEach(tallies.size(), [&](std::size_t chunk) {
            Scratch scratch;
            const std::size_t begin = chunk * kPointsPerChunk;
            for (std::size_t c = begin; c < std::min(points_.size(), begin + kPointsPerChunk);
                 ++c) {
                offer(std::uint32_t(c), context, tallies[chunk], scratch);
            }
        });
        for (const RayTally& t : tallies) context.statistics.add(t);
        context.statistics.hold("light tree bytes", tree_.bytes());
        context.statistics.hold("cut bytes", offers_.size() * sizeof(Offer));
        context.statistics.hold("cache points", points_.size());
        context.statistics.hold("cache point bytes", points_.bytes());
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (options_.nextEvent) proposeFreshLight(context, options_.lamps, rng, sink);
        if (candidates_.empty()) return;
        const auto around = points_.around(points_.serving(context.vertex, context.vertex.asEye));
        const int picks = picks_.at(context.order());
        for (int i = 0; i < picks; ++i) {
            const double u = rng.evenPick(std::uint32_t(i), std::uint32_t(picks));
            if (around.empty()) {
                const Pick pick = pickEvenly(u);
                sink.add({prefixOf(pick), pick.weight / picks, 0});
            } else if (options_.points == Points::Even) {
                // All points see the same pool: none is empty where another is not.
                const std::uint32_t c = around[rng.below(std::uint32_t(around.size()))];
                if (offered_[c] == 0) return;
                const Pick pick = pickAt(c, u);
                sink.add({prefixOf(pick), pick.weight / picks, 0});
            } else {
                const std::uint32_t choice = rng.below(std::uint32_t(around.size()) + 1);
                const bool isVirtual = choice == around.size();
                if (!isVirtual && offered_[around[choice]] == 0) continue;  // counts among the N
                const Pick pick = isVirtual ? pickEvenly(u) : pickAt(around[choice], u);
                const double share = shareOf(choice, around, pick, picks, context);
                if (!(share > 0.0)) continue;
                sink.add(
                    {prefixOf(pick), pick.weight * share * double(around.size() + 1) / picks, 0});
            }
        }
    }

    void observe(const LightPool&, IterationContext& context) override {
        expected_.add(candidates_.size());
        PhaseTimer timer(context.statistics, "cache points");
        CachePoints next(context, options_.cacheDensity, options_.cachePoints, context.generation);
        earlier_.add(std::move(points_), std::move(sums_));
        q_ = earlier_.at(next, context.threads);
        points_ = std::move(next);
    }

  private:
    struct Scratch {
        std::vector<LightTree::CutNode> heap;
        std::vector<LightTree::Cluster> cut;
        std::vector<LightTree::Draw> draws;
        std::vector<double> flows;     // q2* / P1 without visibility, by draw
        std::vector<double> reserves;  // U_j
        std::vector<WeightedVertex> weights;
    };

    /// A light vertex, and the weight that makes its contribution an estimate of the mean
    /// over the pool.
    struct Pick {
        std::uint32_t candidate;
        double weight;
    };
    Subpath prefixOf(const Pick& pick) const { return pool_->prefix(candidates_[pick.candidate]); }
    Pick pickEvenly(double u) const {
        const auto n = double(candidates_.size());
        return {std::uint32_t(u * n), n / double(options_.subpaths)};
    }
    /// Picks by P2 at a point that offers something.
    Pick pickAt(std::uint32_t c, double u) const {
        const Offer* begin = offers_.data() + c * perPoint_;
        const Offer* found =
            std::upper_bound(begin, begin + offered_[c], u,
                             [](double value, const Offer& offer) { return value < offer.cdf; });
        const double pmf = found->cdf - (found == begin ? 0.0 : (found - 1)->cdf);
        return {found->candidate, found->scale / pmf};
    }

    /// a_c(y) of the choice that made the pick. The choices are the points around, then
    /// the virtual one.
    double shareOf(std::uint32_t choice, std::span<const std::uint32_t> around, const Pick& pick,
                   double n, const EyeContext& context) const {
        const Subpath light = prefixOf(pick);
        const PathSpace::Arrival a = context.space.arrival(light, context.eyePath, false);
        const TwoStageDensity::Offered y{&light.back(), double(mean(light.back().throughput)),
                                         double(mean(a.flow)), a.geometry};
        const double ofVirtual = density_.samplesOfVirtual(n);
        double sum = ofVirtual, chosen = choice == around.size() ? ofVirtual : 0.0;
        for (std::uint32_t i = 0; i < around.size(); ++i) {
            const double samples = density_.samplesAt(around[i], y, n);
            if (!(samples > 0.0)) continue;
            if (i != choice && !offersAt(around[i], light, context)) continue;
            sum += samples;
            if (i == choice) chosen = samples;
        }
        return chosen / sum;
    }
    /// Whether a point may pick the vertex, if the first stage has drawn it from its cluster.
    bool offersAt(std::uint32_t c, Subpath light, const EyeContext& context) const {
        if (options_.defensive > 0.0) return true;
        const Subpath eye = points_.eye(c);
        const PathSpace::Arrival a = context.space.arrival(light, eye, false);
        return mean(a.flow) > 0.0f && a.geometry > 0.0 &&
               context.space.visible(light.back(), eye.back(), context.tally);
    }

    /// G without cosines, so that no U_j of a vertex with power is zero.
    static double falloff(const PathVertex& light, const PathVertex& eye, double limit) {
        if (light.infinite()) return 1.0;
        const double d2 = lengthSquared(Vec3d(light.position) - Vec3d(eye.position));
        return d2 * limit > 1.0 ? 1.0 / d2 : limit;
    }

    /// Runs both stages at cache point `c`.
    void offer(std::uint32_t c, const IterationContext& context, RayTally& tally, Scratch& s) {
        const Subpath eye = points_.eye(c);
        const double limit = points_.inverseSquareLimit(c);
        const double perSubpath = 1.0 / double(options_.subpaths);
        tree_.cut(eye.back(), options_.clusters, s.heap, s.cut);
        Rng rng(context.seed, context.generation, StreamKind::CacheDraw, c);
        s.draws.clear();
        s.flows.clear();
        s.reserves.clear();
        s.weights.clear();
        for (const LightTree::Cluster cluster : s.cut) {
            const auto j = std::uint32_t(s.draws.size());
            const LightTree::Draw draw = tree_.draw(cluster, rng.uniformDouble());
            s.draws.push_back(draw);
            const Subpath light = pool_->prefix(candidates_[draw.candidate]);
            const double own = double(mean(light.back().throughput));
            s.reserves.push_back(own / draw.pmf * falloff(light.back(), eye.back(), limit));
            const PathSpace::Arrival a = context.space.arrival(light, eye, false);
            const double g = points_.limited(c, light.back(), a.geometry);
            const double flow = double(mean(a.flow));
            sums_[2 * c] += own / draw.pmf * g * perSubpath;
            s.flows.push_back(flow * g / draw.pmf);
            const double target =
                options_.secondStage == SecondStage::Energy ? s.flows.back() : flow / own;
            if (target > 0.0) s.weights.push_back({j, target});
        }
        std::erase_if(s.weights, [&](const WeightedVertex& w) {
            const Subpath light = pool_->prefix(candidates_[s.draws[w.index].candidate]);
            return !context.space.visible(light.back(), eye.back(), tally);
        });
        for (const WeightedVertex& w : s.weights) {
            sums_[2 * c + 1] += s.flows[w.index] * perSubpath;
        }
        fill(c, perSubpath, s);
    }

    /// Sets P2 over the draws.
    void fill(std::uint32_t c, double perSubpath, const Scratch& s) {
        double total = 0.0, reserve = 0.0;
        for (const WeightedVertex& w : s.weights) total += w.weight;
        for (const double u : s.reserves) reserve += u;
        if (!(total > 0.0) && options_.defensive == 0.0) return;  // offers nothing
        const double defensive = total > 0.0 ? options_.defensive : 1.0;
        double cdf = 0.0;
        auto weight = s.weights.begin();
        Offer* out = offers_.data() + c * perPoint_;
        std::uint32_t last = 0;  // the last draw that can be picked
        for (std::uint32_t j = 0; j < s.draws.size(); ++j) {
            const LightTree::Draw& draw = s.draws[j];
            const double before = cdf;
            cdf += defensive * s.reserves[j] / reserve;
            if (weight != s.weights.end() && weight->index == j) {
                cdf += (1.0 - defensive) * weight->weight / total;
                ++weight;
            }
            if (cdf > before) last = j;
            out[j] = {draw.candidate, cdf, perSubpath / draw.pmf};
        }
        // The sum is one but for rounding: the last draw that can be picked closes it.
        for (std::size_t j = last; j < s.draws.size(); ++j) out[j].cdf = 1.0;
        offered_[c] = std::uint32_t(s.draws.size());
    }

    Options options_;
    Picks picks_;
    PicksDensity plain_;
    TwoStageDensity density_;
    CachePoints points_;     // of this iteration
    std::vector<double> q_;  // Q1, Q2 by point, from earlier iterations
    EarlierValues earlier_;
    ExpectedVertices expected_;
    const LightPool* pool_ = nullptr;
    std::vector<LightPool::Entry> candidates_;
    LightTree tree_;
    std::size_t perPoint_ = 0;
    std::vector<Offer> offers_;           // perPoint_ each
    std::vector<std::uint32_t> offered_;  // how many of them, by point
    std::vector<double> sums_;            // Q1, Q2 as this iteration has them, by point
};

}  // namespace

MethodRow tsrbptRow() {
    OptionTable<Options> table;
    table.integer("candidates", &Options::subpaths, 1, 1e8, "light subpaths", "in the pool, M1");
    table.include("", &Options::picks, pickOptions(Options{}.picks));
    table.integer("second_candidates", &Options::clusters, 1, 1e6, "clusters", "of a cut, M2");
    addCachePoints(table, &Options::cacheDensity, &Options::cachePoints);
    table.choice<Points>("points", &Options::points,
                         {{"even", Points::Even}, {"weighted", Points::Weighted}},
                         "how the cache points around an eye vertex share its picks: equally; or "
                         "by the density that the weights give to each, with one more point that "
                         "picks uniformly from the pool (the paper)");
    table.real("defensive", &Options::defensive, 0, 0.99, "share",
               "of the second stage's probability that follows power and distance alone; 0 only "
               "with points=weighted");
    table.choice<SecondStage>("target", &Options::secondStage,
                              {{"energy", SecondStage::Energy}, {"printed", SecondStage::Printed}},
                              "what the second stage is proportional to: target over proposal, or "
                              "q2/q1 as the paper prints it");
    table.choice<Weights>("weights", &Options::weights,
                          {{"tsr", Weights::Tsr}, {"ris", Weights::Ris}, {"plain", Weights::Plain}},
                          "density that the weights use: both stages, the second alone, or r = 1");
    addClamp(table, &Options::clamp);
    addEarlierIterations(table, &Options::earlierIterations);
    addEyeShare(table, &Options::eyeShare);
    addNextEvent(table, &Options::nextEvent, &Options::lamps);
    table.include("", &Options::merging, mergeOptions());
    return methodRow(
        {.name = "tsrbpt",
         .reference = "Nabata20b",
         .summary = "two-stage resampling at cache points: by a cut of a light tree, then by a pmf",
         .techniques = {.hits = true, .connects = true, .splats = true},
         .paper = {"first_connections=0", "eye_share=0", "lamps=power", "next_event=off",
                   "q_iterations=1", "cache_points=3", "points=weighted", "target=printed",
                   "defensive=0"}},
        table, [](const Options& o) {
            if (o.defensive == 0.0 && o.points == Points::Even) {
                throw UsageError(
                    "defensive: expected a share above 0 with points=even, found 0: nothing would "
                    "pick light vertices that a cache point does not see");
            }
            return std::make_unique<TwoStageResampling>(o);
        });
}

}  // namespace lacuna

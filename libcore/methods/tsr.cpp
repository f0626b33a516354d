// Two-stage resampling [Nabata20b]: many light subpaths, thinned out at every cache point by a cut
// through a light tree before the costly target is looked at. Notation of methods.md 2.
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
//   MIS       the mean over the N_c points of                                       [eq 17]
//                 [ 1/M1 + (1 - 1/M1) ( (1/M2) p/q1 + (1 - 1/M2) p/q2 / (N (1 - d)) ) ]^-1,
//             (as printed: N = 1, d = 0)
//             p/q1 = Q1(c) / q1*(y, z), p/q2 = Q2(c) / q2*(y, z), each at least `clamp`, V = 1;
//             Q1 = (1/M1) sum_j B_j G, Q2 = (1/M1) sum_j T_j of earlier iterations,
//             averaged (as printed: of the one before)
//             where Q2(c) = 0 only stage 1 helps: p/q1 takes the place of p/q2;
//             then withEyeShare (as printed: no share)
#include <algorithm>

#include "libcore/base/parallel.h"
#include "libcore/methods/cache_pmfs.h"
#include "libcore/methods/cache_points.h"
#include "libcore/methods/light_tree.h"
#include "libcore/methods/methods.h"

namespace lacuna {

namespace {

constexpr std::size_t kPointsPerChunk = 32;

enum class Weights { Tsr, Ris, Plain };
enum class SecondStage { Energy, Printed };

struct Options {
    std::uint64_t subpaths;  ///< M1
    std::uint32_t clusters;  ///< M2
    double cacheDensity;
    Picks picks;      ///< N
    int cachePoints;  ///< N_c
    int qPoints;      ///< N_q
    int qSets;        ///< earlier iterations whose Q are averaged
    double clamp;
    double eyeShare;
    double defensive;  ///< d
    double untested;   ///< removeHidden
    SecondStage secondStage;
    Weights weights;
    bool nextEvent;
};

class TwoStageDensity final : public ConnectionDensity {
  public:
    explicit TwoStageDensity(const Options& options) : options_(options) {}

    void freeze(const CachePoints& points, std::span<const double> q, double expectedVertices) {
        points_ = &points;
        q_ = q;
        const auto m1 = double(options_.subpaths);
        uniform_ = m1 / expectedVertices;
    }

    bool tagsVertices() const override { return true; }
    std::uint32_t tagOf(const PathVertex& vertex) const override {
        return points_->nearest(vertex.position);
    }

    double effectiveSamples(const Connection& c) const override {
        if (options_.nextEvent && c.light.count == 1) return 1.0;
        const double n = options_.picks.at(c.order);
        const auto around = points_->around(points_->serving(*c.eye.vertex));
        if (around.empty()) return n * uniform_;
        const double power = double(mean(c.beta));
        const double flow = double(mean(c.beta * c.light.scatter));
        if (!(power > 0.0) || !(flow > 0.0)) return 0.0;  // in no cluster, or nothing to carry
        double sum = 0.0;
        for (const std::uint32_t i : around) {
            const double g = points_->trustedGeometry(i, *c.light.vertex, c.geometry);
            const double q1 = q_[2 * i], q2 = q_[2 * i + 1];
            const double ratio1 = std::max(options_.clamp, q1 / (power * g));
            const double ratio2 = q2 > 0.0 ? std::max(options_.clamp, q2 / (flow * g)) : ratio1;
            sum += effective(ratio1, ratio2 / (n * (1.0 - options_.defensive)));
        }
        return withEyeShare(sum / double(around.size()), c.order, options_.eyeShare);
    }

  private:
    double effective(double ratio1, double ratio2) const {
        const double m1 = 1.0 / double(options_.subpaths), m2 = 1.0 / double(options_.clusters);
        if (options_.weights == Weights::Ris) return 1.0 / (m2 + (1.0 - m2) * ratio2);
        return 1.0 / (m1 + (1.0 - m1) * (m2 * ratio1 + (1.0 - m2) * ratio2));
    }

    Options options_;
    const CachePoints* points_ = nullptr;
    std::span<const double> q_;  // Q1, Q2 by cache point
    double uniform_ = 1.0;
};

/// What a cache point offers: one light vertex per cluster, with the distribution P2 over them.
struct Offer {
    std::uint32_t candidate;
    double cdf;
    double scale;  ///< 1 / (M1 P1)
};

class TwoStageResampling final : public Method {
  public:
    explicit TwoStageResampling(const Options& options)
        : options_(options),
          plain_(options.picks, options.nextEvent, 1.0),
          density_(options),
          earlier_(2, options.qSets, options.qPoints) {}

    // The first leaves cache points, the second finds their Q.
    int warmupIterations() const override { return 2; }
    PoolRequest pool() const override { return {options_.subpaths}; }
    bool learns() const override { return true; }

    const ConnectionDensity& freeze(std::uint32_t) override {
        if (options_.weights == Weights::Plain) return plain_;
        const double expected = pools_ ? double(vertices_) / double(pools_) : 0.0;
        density_.freeze(points_, q_, std::max(expected, 1.0));
        return density_;
    }

    void prepare(const LightPool& pool, IterationContext& context) override {
        pool_ = &pool;
        candidates_.clear();
        for (const LightPool::Entry& e : pool.connectable()) {
            if (!options_.nextEvent || e.count > 1) candidates_.push_back(e);
        }
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
        if (options_.nextEvent) proposeFreshLight(context, rng, sink);
        const auto around = points_.around(points_.serving(context.vertex));
        const int picks = options_.picks.at(context.order());
        for (int i = 0; i < picks; ++i) {
            const double u = rng.uniformDouble();
            if (around.empty()) {
                const std::size_t n = candidates_.size();
                if (n == 0) return;
                sink.add({pool_->prefix(candidates_[std::size_t(u * double(n))]),
                          double(n) / (double(options_.subpaths) * picks), 0});
                continue;
            }
            // All points see the same pool: none is empty where another is not.
            const std::uint32_t c = around[rng.below(std::uint32_t(around.size()))];
            if (offered_[c] == 0) return;
            const Offer* begin = offers_.data() + c * perPoint_;
            const Offer* found = std::upper_bound(
                begin, begin + offered_[c], u,
                [](double value, const Offer& offer) { return value < offer.cdf; });
            const double pmf = found->cdf - (found == begin ? 0.0 : (found - 1)->cdf);
            sink.add(
                {pool_->prefix(candidates_[found->candidate]), found->scale / (pmf * picks), 0});
        }
    }

    void observe(const LightPool&, IterationContext& context) override {
        vertices_ += candidates_.size();
        ++pools_;
        PhaseTimer timer(context.statistics, "cache points");
        CachePoints next(context, options_.cacheDensity, options_.cachePoints, generation_++);
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

    /// G without cosines, so that nothing that has power is ever zero.
    static double falloff(const PathVertex& light, const PathVertex& eye, double limit) {
        if (light.infinite()) return 1.0;
        const double d2 = lengthSquared(Vec3d(light.position) - Vec3d(eye.position));
        return d2 * limit > 1.0 ? 1.0 / d2 : limit;
    }

    /// Both stages at cache point `c`.
    void offer(std::uint32_t c, const IterationContext& context, RayTally& tally, Scratch& s) {
        const Subpath eye = points_.eye(c);
        const double limit = points_.inverseSquareLimit(c);
        const double perSubpath = 1.0 / double(options_.subpaths);
        tree_.cut(eye.back(), options_.clusters, s.heap, s.cut);
        Rng rng(context.seed, generation_, StreamKind::CacheDraw, c);
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
        removeHidden(s.weights, options_.untested, [&](std::uint32_t j) {
            const Subpath light = pool_->prefix(candidates_[s.draws[j].candidate]);
            return context.space.visible(light.back(), eye.back(), tally);
        });
        for (const WeightedVertex& w : s.weights) {
            sums_[2 * c + 1] += s.flows[w.index] * perSubpath;
        }
        fill(c, perSubpath, s);
    }

    /// P2 over the draws.
    void fill(std::uint32_t c, double perSubpath, const Scratch& s) {
        double total = 0.0, reserve = 0.0;
        for (const WeightedVertex& w : s.weights) total += w.weight;
        for (const double u : s.reserves) reserve += u;
        const double defensive = total > 0.0 ? options_.defensive : 1.0;
        double cdf = 0.0;
        auto weight = s.weights.begin();
        Offer* out = offers_.data() + c * perPoint_;
        for (std::uint32_t j = 0; j < s.draws.size(); ++j) {
            const LightTree::Draw& draw = s.draws[j];
            cdf += defensive * s.reserves[j] / reserve;
            if (weight != s.weights.end() && weight->index == j) {
                cdf += (1.0 - defensive) * weight->weight / total;
                ++weight;
            }
            out[j] = {draw.candidate, cdf, perSubpath / draw.pmf};
        }
        // Ends at one but for rounding; every cluster has a share, so the last one may close it.
        out[s.draws.size() - 1].cdf = 1.0;
        offered_[c] = std::uint32_t(s.draws.size());
    }

    Options options_;
    PicksDensity plain_;
    TwoStageDensity density_;
    CachePoints points_;     // of this iteration
    std::vector<double> q_;  // Q1, Q2 by point, from earlier iterations
    EarlierValues earlier_;
    std::uint64_t vertices_ = 0, pools_ = 0;
    std::uint32_t generation_ = 0;
    const LightPool* pool_ = nullptr;
    std::vector<LightPool::Entry> candidates_;
    LightTree tree_;
    std::size_t perPoint_ = 0;
    std::vector<Offer> offers_;           // perPoint_ each
    std::vector<std::uint32_t> offered_;  // how many of them, by point
    std::vector<double> sums_;            // Q1, Q2 as this iteration has them, by point
};

}  // namespace

MethodRow twoStageResamplingRow() {
    using Kind = Parameter::Kind;
    MethodRow row;
    row.name = "tsrbpt";
    row.reference = "Nabata20b";
    row.summary = "two-stage resampling: a light tree's cut at every cache point, then its pmf";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.parameters = {
        lightPathsParameter(),
        {"candidates", Kind::Integer, 1e4, 1, 1e8, "light subpaths in the pool, M1"},
        connectionsParameter(1),
        firstConnectionsParameter(8),
        {"second_candidates", Kind::Integer, 200, 1, 1e6, "clusters of a cut, M2"},
        {"cache_density", Kind::Real, 0.004, 0, 16,
         "eye subpaths that leave cache points, per pixel"},
        {"cache_points", Kind::Integer, 1, 1, 16, "cache points that serve an eye vertex, N_c"},
        {"q_points", Kind::Integer, 3, 1, 16,
         "cache points of the last iteration whose Q are averaged, N_q"},
        {"q_iterations", Kind::Integer, 16, 1, 256,
         "earlier iterations whose Q are averaged; the paper: 1"},
        {"clamp", Kind::Real, 1e-3, 0, 1, "lower limit of p/q in the weights"},
        eyeShareParameter(0.1),
        {"defensive", Kind::Real, 0.7, 1e-6, 0.99,
         "share of the second stage that goes by power and distance alone"},
        {"untested", Kind::Real, 0.0, 0, 1,
         "share of a pmf, its smallest entries, that no visibility rays are spent on"},
        {"target",
         Kind::Choice,
         0,
         0,
         1,
         "second stage: target over proposal, or q2/q1 as printed",
         {"energy", "printed"}},
        {"weights",
         Kind::Choice,
         0,
         0,
         2,
         "density that the weights see: both stages, the second alone, or r = 1",
         {"tsr", "ris", "plain"}},
        nextEventParameter(true),
        presetParameter()};
    row.paper = {{"first_connections", 0}, {"eye_share", 0},    {"next_event", 0},
                 {"q_iterations", 1},      {"cache_points", 3}, {"target", 1},
                 {"defensive", 0.25}};
    row.create = [](const Settings& s) -> std::unique_ptr<Method> {
        Options o;
        o.subpaths = s.integer("candidates");
        o.clusters = std::uint32_t(s.integer("second_candidates"));
        o.cacheDensity = s.real("cache_density");
        o.picks = picksOf(s);
        o.cachePoints = int(s.integer("cache_points"));
        o.qPoints = int(s.integer("q_points"));
        o.qSets = int(s.integer("q_iterations"));
        o.clamp = s.real("clamp");
        o.eyeShare = s.real("eye_share");
        o.defensive = s.real("defensive");
        o.untested = s.real("untested");
        o.secondStage = SecondStage(s.integer("target"));
        o.weights = Weights(s.integer("weights"));
        o.nextEvent = s.on("next_event");
        return std::make_unique<TwoStageResampling>(o);
    };
    return row;
}

}  // namespace lacuna

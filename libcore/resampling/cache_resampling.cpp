// (theory.md, "Cache points", "risbpt")
#include "libcore/resampling/cache_resampling.h"

#include <algorithm>

#include "libcore/base/parallel.h"
#include "libcore/resampling/cache_points.h"

namespace lacuna {

namespace {

constexpr std::size_t kPointsPerChunk = 32;

/// n r of the resampling-aware weights; frozen for an iteration.
class ResampledDensity final : public ConnectionDensity {
  public:
    explicit ResampledDensity(const CacheResamplingOptions& options)
        : options_(options), picks_(options.picks.picks()) {}

    void freeze(const CachePoints& points, std::span<const double> q, double expectedVertices) {
        points_ = &points;
        q_ = q;
        const auto m = double(options_.subpaths);
        perSubpath_ = 1.0 / m;
        perVertex_ = m / expectedVertices;
    }

    Lamps lamps() const override { return lampsOf(options_.nextEvent, options_.lamps); }
    bool keepsLabels() const override { return true; }
    void labelWalk(std::span<PathVertex> walk) const override { points_->labelAsEye(walk); }

    double effectiveSamples(const Connection& c) const override {
        if (options_.nextEvent && c.light.count == 1) return 1.0;
        Rgb flow = c.beta * c.light.scatter;
        if (options_.target == CacheTarget::FlowThrough) flow *= c.eye.scatter;
        const double value = double(mean(flow));
        const auto around = points_->around(points_->serving(*c.eye.vertex, c.eye.label));
        const double n = picks_.at(c.order), rest = (1.0 - perSubpath_) / n;
        double sum = n * perVertex_;
        for (const std::uint32_t i : around) {
            const double target = value * points_->trustedGeometry(i, *c.light.vertex, c.geometry);
            if (q_[i] > 0.0 && target > 0.0) {
                sum += 1.0 / (perSubpath_ + rest * std::max(options_.clamp, q_[i] / target));
            }
        }
        return withEyeShare(sum / double(around.size() + 1), c.order, options_.eyeShare);
    }

  private:
    CacheResamplingOptions options_;
    Picks picks_;
    const CachePoints* points_ = nullptr;
    std::span<const double> q_;
    double perSubpath_ = 1.0, perVertex_ = 1.0;
};

class CacheResampling final : public Method {
  public:
    explicit CacheResampling(const CacheResamplingOptions& options)
        : options_(options),
          picks_(options.picks.picks()),
          plain_(picks_, options.nextEvent, options.lamps, 1.0),
          density_(options),
          earlier_(1, options.earlierIterations, kEarlierPoints) {}

    // The first warm-up counts vertices and leaves cache points, the second finds their Q.
    int warmupIterations() const override { return 2; }
    PoolRequest pool() const override { return {options_.subpaths}; }
    Merging merging() const override { return options_.merging.merging(); }
    bool learns() const override { return true; }

    const ConnectionDensity& freeze(std::uint32_t) override {
        if (!aware()) return plain_;
        density_.freeze(points_, q_, expected_.value());
        return density_;
    }

    void prepare(const LightPool& pool, IterationContext& context) override {
        pool_ = &pool;
        takePickable(pool, !options_.nextEvent, candidates_);
        flow_.assign(points_.size(), 0.0);
        std::vector<CachePmfs::Builder> rows((points_.size() + kPointsPerChunk - 1) /
                                             kPointsPerChunk);
        std::vector<RayTally> tallies(rows.size());
        context.threads.forEach(rows.size(), [&](std::size_t chunk) {
            std::vector<WeightedVertex> weights;
            const std::size_t begin = chunk * kPointsPerChunk;
            for (std::size_t c = begin; c < std::min(points_.size(), begin + kPointsPerChunk);
                 ++c) {
                weigh(std::uint32_t(c), context.space, tallies[chunk], weights);
                for (const WeightedVertex& w : weights) flow_[c] += w.weight;
                flow_[c] /= double(options_.subpaths);
                rows[chunk].add(weights);
            }
        });
        for (const RayTally& t : tallies) context.statistics.add(t);
        pmfs_ = CachePmfs(rows);
        context.statistics.hold("distribution bytes", pmfs_.bytes());
        context.statistics.hold("cache points", points_.size());
        context.statistics.hold("cache point bytes", points_.bytes());
        if (options_.currentQ) std::copy(flow_.begin(), flow_.end(), q_.begin());
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (options_.nextEvent) proposeFreshLight(context, options_.lamps, rng, sink);
        if (candidates_.empty()) return;
        const double uniform = 1.0 / double(candidates_.size());
        const auto around = points_.around(points_.serving(context.vertex, context.vertex.asEye));
        const auto filled = std::size_t(std::count_if(
            around.begin(), around.end(), [&](std::uint32_t c) { return !pmfs_.empty(c); }));
        const int picks = picks_.at(context.order());
        for (int n = 0; n < picks; ++n) {
            const auto [choice, u] = choose(rng, std::uint32_t(filled) + 1, n, picks);
            std::uint32_t index = 0;
            if (choice == filled) {
                index = std::uint32_t(u * double(candidates_.size()));
            } else {
                std::uint32_t skipped = 0;
                for (const std::uint32_t c : around) {
                    if (pmfs_.empty(c) || skipped++ != choice) continue;
                    index = pmfs_.pick(c, u).index;
                    break;
                }
            }
            double sum = uniform;
            for (const std::uint32_t c : around) sum += pmfs_.pmf(c, index);
            sink.add({pool_->prefix(candidates_[index]),
                      double(filled + 1) / (sum * double(options_.subpaths) * picks), 0});
        }
    }

    void observe(const LightPool&, IterationContext& context) override {
        expected_.add(candidates_.size());
        PhaseTimer timer(context.statistics, "cache points");
        CachePoints next(context, options_.cacheDensity, options_.cachePoints, context.generation);
        if (aware()) {
            earlier_.add(std::move(points_), std::move(flow_));
            q_ = earlier_.at(next, context.threads);
        }
        points_ = std::move(next);
        pmfs_ = {};
    }

  private:
    bool aware() const { return options_.weights == CacheResamplingOptions::Weights::Ris; }

    /// The target of every light vertex at cache point `c`, zeros left out.
    void weigh(std::uint32_t c, const PathSpace& space, RayTally& tally,
               std::vector<WeightedVertex>& weights) const {
        const Subpath eye = points_.eye(c);
        const bool throughEye = options_.target == CacheTarget::FlowThrough;
        weights.clear();
        for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
            const Subpath light = pool_->prefix(candidates_[i]);
            const PathSpace::Arrival a = space.arrival(light, eye, throughEye);
            const Rgb value = throughEye ? a.scattered : a.flow;
            const double weight =
                double(mean(value)) * points_.limited(c, light.back(), a.geometry);
            if (weight > 0.0) weights.push_back({i, weight});
        }
        std::erase_if(weights, [&](const WeightedVertex& w) {
            return !space.visible(pool_->prefix(candidates_[w.index]).back(), eye.back(), tally);
        });
    }

    CacheResamplingOptions options_;
    Picks picks_;
    PicksDensity plain_;
    ResampledDensity density_;
    CachePoints points_;     // of this iteration
    std::vector<double> q_;  // by point, from earlier iterations
    EarlierValues earlier_;
    ExpectedVertices expected_;
    const LightPool* pool_ = nullptr;
    std::vector<LightPool::Entry> candidates_;
    CachePmfs pmfs_;
    std::vector<double> flow_;  // (1/M) sum of the target, by point
};

}  // namespace

std::unique_ptr<Method> makeCacheResampling(const CacheResamplingOptions& options) {
    return std::make_unique<CacheResampling>(options);
}

OptionTable<CacheResamplingOptions> cacheResamplingOptions(const CacheResamplingOptions& defaults) {
    using O = CacheResamplingOptions;
    OptionTable<O> table(defaults);
    table.integer("candidates", &O::subpaths, 1, 1e6, "light subpaths", "in the pool, M");
    table.include("", &O::picks, pickOptions(defaults.picks));
    addCachePoints(table, &O::cacheDensity, &O::cachePoints);
    table.choice<CacheTarget>(
        "target", &O::target,
        {{"flow", CacheTarget::Flow}, {"flow-bsdf", CacheTarget::FlowThrough}},
        "what pmfs are proportional to: light that arrives at the cache point, or the part of it "
        "that the BSDF there scatters towards the eye");
    addNextEvent(table, &O::nextEvent, &O::lamps);
    return table;
}

OptionTable<CacheResamplingOptions> awareResamplingOptions(const CacheResamplingOptions& defaults) {
    using O = CacheResamplingOptions;
    OptionTable<O> table = cacheResamplingOptions(defaults);
    addClamp(table, &O::clamp);
    addEyeShare(table, &O::eyeShare);
    return table;
}

}  // namespace lacuna

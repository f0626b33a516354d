// Subspace-based probabilistic connections [Su22].
//
//   pool      Y, all connectable vertices of M light subpaths, new in every iteration, binned into
//             light subspaces: LVC_i
//   classes   i = kappa_L(y), j = kappa_E(z): decision trees on position, normal and incident
//             direction, cells of the lights for s = 1                        [Su22 6.4, 7.2]
//   stage 1   i with probability Gamma(i given j)                             [Su22 6.1]
//   stage 2   y out of LVC_i with probability P_r = mean(beta) / sum of mean(beta) in LVC_i [eq 9]
//   pick      N per eye vertex; contribution h(y) / (M N Gamma P_r)           [eq 10]
//             an empty LVC_i is a zero sample that counts among the N
//   MIS       paper: r = N Gamma beta / Q(i)                                  [eq 11, 12]
//             ris:   r = [ (1/(N Gamma)) (1/M + (1 - 1/M) Q(i)/beta) + (1 - 1/N)/M ]^-1, which
//             knows that one of M subpaths is not always there: the paper's where beta << M Q(i)
//             Gamma, Q, trees: frozen since lacuna-train; Q = 0: not seen there, see unseenQ
//   t = 1     never resampled;  s = 0 ordinary
//
// Without subspaces there is one of each, Gamma = 1, and Q comes from a warm-up that is thrown
// away: light vertices are picked in proportion to beta alone.
#include <numeric>

#include "libcore/base/discrete.h"
#include "libcore/base/parallel.h"
#include "libcore/methods/methods.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna {

namespace {

constexpr std::size_t kEntriesPerTask = 4096;

struct Options {
    std::uint64_t subpaths;  ///< M
    int picks;               ///< N
    bool resamplingAware;    ///< the weights: ris, or the paper's
};

/// Subspaces made ready to draw from.
class Classes {
  public:
    explicit Classes(std::shared_ptr<const Subspaces> subspaces)
        : subspaces_(std::move(subspaces)), q_(subspaces_->q) {
        std::vector<double> weights;
        for (std::uint32_t j = 0; j < subspaces_->eyeCount; ++j) {
            const auto column = subspaces_->column(j);
            weights.assign(column.begin(), column.end());
            columns_.emplace_back(weights);
        }
        unseen_ = unseenQ(q_, subspaces_->lightPaths);
    }

    bool measured() const { return !q_.empty(); }
    void setQ(std::vector<double> q, std::uint64_t lightPaths) {
        q_ = std::move(q);
        unseen_ = unseenQ(q_, lightPaths);
    }

    std::uint32_t lightCount() const { return subspaces_->lightCount; }
    std::uint32_t lightOf(const PathVertex& y, const PathVertex* predecessor) const {
        return subspaces_->lightSubspace(y, predecessor);
    }
    /// Gamma's column of an eye vertex.
    const DiscreteDistribution& columnOf(const PathVertex& z, const PathVertex& predecessor) const {
        return columns_[subspaces_->eyeSubspace(z, predecessor)];
    }
    /// 0 where no light subpath was seen.
    double q(std::uint32_t light) const { return q_.empty() ? 0.0 : q_[light]; }
    double unseen() const { return unseen_; }

  private:
    std::shared_ptr<const Subspaces> subspaces_;
    std::vector<DiscreteDistribution> columns_;  // by eye subspace
    std::vector<double> q_;
    double unseen_ = 1.0;
};

class SubspaceDensity final : public ConnectionDensity {
  public:
    SubspaceDensity(const Options& options, const Classes& classes)
        : options_(options), classes_(classes) {}

    double effectiveSamples(const Connection& c) const override {
        const auto beta = double(mean(c.beta));
        if (!(beta > 0.0)) return 0.0;  // never picked in stage 2
        const std::uint32_t i = classes_.lightOf(*c.light.vertex, c.light.predecessor);
        const double gamma = classes_.columnOf(*c.eye.vertex, *c.eye.predecessor).pmf(i);
        if (!(gamma > 0.0)) return 0.0;
        const double q = classes_.q(i), n = options_.picks, m = double(options_.subpaths);
        if (!options_.resamplingAware) return n * gamma * beta / (q > 0.0 ? q : classes_.unseen());
        return 1.0 / ((1.0 / m + (1.0 - 1.0 / m) * q / beta) / (n * gamma) + (1.0 - 1.0 / n) / m);
    }

  private:
    const Options& options_;
    const Classes& classes_;
};

class SubspaceConnections final : public Method {
  public:
    explicit SubspaceConnections(const Options& options)
        : options_(options),
          classes_(std::make_shared<const Subspaces>()),
          density_(options_, classes_) {}

    void useSubspaces(std::shared_ptr<const Subspaces> subspaces) override {
        classes_ = Classes(std::move(subspaces));
    }
    int warmupIterations() const override { return classes_.measured() ? 0 : 1; }
    PoolRequest pool() const override { return {options_.subpaths}; }

    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }

    void prepare(const LightPool& pool, IterationContext& context) override {
        pool_ = &pool;
        const auto entries = pool.connectable();
        std::vector<std::uint32_t> labels(entries.size());
        context.threads.forEach(tasksFor(entries.size()), [&](std::size_t task) {
            const std::size_t begin = task * kEntriesPerTask;
            for (std::size_t n = begin; n < std::min(entries.size(), begin + kEntriesPerTask);
                 ++n) {
                const Subpath y = pool.prefix(entries[n]);
                labels[n] = classes_.lightOf(y.back(), y.size() > 1 ? &y[y.size() - 2] : nullptr);
            }
        });
        const std::uint32_t count = classes_.lightCount();
        begin_.assign(std::size_t(count) + 1, 0);
        for (const std::uint32_t i : labels) ++begin_[i + 1];
        std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
        members_.resize(entries.size());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        for (std::size_t n = 0; n < entries.size(); ++n) members_[next[labels[n]]++] = entries[n];
        within_.assign(count, {});
        context.threads.forEach(count, [&](std::size_t i) {
            std::vector<double> weights;
            for (std::size_t n = begin_[i]; n < begin_[i + 1]; ++n) {
                weights.push_back(double(mean(pool.prefix(members_[n]).back().throughput)));
            }
            within_[i] = DiscreteDistribution(weights);
        });
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        const DiscreteDistribution& column =
            classes_.columnOf(context.vertex, context.predecessor());
        const double nm = double(options_.picks) * double(options_.subpaths);
        for (int n = 0; n < options_.picks; ++n) {
            const auto subspace = column.sample(rng.uniformDouble());
            const DiscreteDistribution& within = within_[subspace.index];
            if (within.empty()) continue;
            const auto pick = within.sample(subspace.remapped());
            sink.add({pool_->prefix(members_[begin_[subspace.index] + pick.index]),
                      1.0 / (nm * subspace.pmf * pick.pmf), 0});
        }
    }

    void observe(const LightPool&, IterationContext&) override {
        if (classes_.measured()) return;
        std::vector<double> q;
        for (const DiscreteDistribution& d : within_) {
            q.push_back(d.total() / double(options_.subpaths));
        }
        classes_.setQ(std::move(q), options_.subpaths);
    }

  private:
    static std::size_t tasksFor(std::size_t entries) {
        return (entries + kEntriesPerTask - 1) / kEntriesPerTask;
    }

    Options options_;
    Classes classes_;
    SubspaceDensity density_;
    const LightPool* pool_ = nullptr;
    std::vector<LightPool::Entry> members_;     // of the pool, by light subspace
    std::vector<std::size_t> begin_;            // by light subspace, into members_
    std::vector<DiscreteDistribution> within_;  // P_r, by light subspace
};

}  // namespace

MethodRow subspaceRow() {
    using Kind = Parameter::Kind;
    MethodRow row;
    row.name = "spcbpt";
    row.reference = "Su22";
    row.summary = "light vertices resampled in two stages, by trained subspaces of light subpaths";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.needsSubspaces = true;
    row.parameters = {
        lightPathsParameter(),
        {"candidates", Kind::Integer, 1e5, 1, 1e8, "light subpaths in the pool, M"},
        {"connections", Kind::Integer, 3, 1, 64, "picks per eye vertex, N"},
        {"weights",
         Kind::Choice,
         0,
         0,
         1,
         "density that the weights see: resampling-aware, or the target alone (the paper)",
         {"ris", "paper"}},
        {"train.paths", Kind::Integer, 1e6, 1, 1e8, "full paths to train with"},
        {"train.subspaces", Kind::Integer, 1000, 1, 4000,
         "subspaces of light and of eye subpaths"},
        {"train.light_paths", Kind::Integer, 2e6, 1, 1e9, "light subpaths for Q"},
        {"train.epochs", Kind::Integer, 20, 0, 10000, "passes over the paths to optimise Gamma"},
        presetParameter()};
    row.paper = {{"weights", 1}};
    row.create = [](const Settings& s) {
        return std::make_unique<SubspaceConnections>(Options{
            s.integer("candidates"), int(s.integer("connections")), s.integer("weights") == 0});
    };
    return row;
}

}  // namespace lacuna

// Subspace-based probabilistic connections [Su22]. (theory.md, "spcbpt")
//
//   pool      Y, all connectable vertices of M light subpaths, new in every iteration, binned into
//             light subspaces: LVC_i
//   classes   i = kappa_L(y), j = kappa_E(z): decision trees on position, normal and incident
//             direction, cells of the lights for s = 1                        [Su22 6.4, 7.2]
//   stage 1   i with probability Gamma(i given j)                             [Su22 6.1]
//   stage 2   y out of LVC_i with probability P_r = mean(beta) / sum of mean(beta) in LVC_i [eq 9]
//   pick      N per eye vertex; contribution h(y) / (M N Gamma P_r)           [eq 10]
//             an empty LVC_i is a zero sample that counts among the N
//             N by order: more at the first eye vertex, fewer after the second, where a pick
//             carries less (the paper: one N)
//   reuse     subspace i keeps all its vertices of the last W_i = ceil(M_0 / (M v_i)) whole
//             iterations, v_i its vertices per subpath, frozen from lacuna-train: 1/M becomes
//             1/(min(j, W_i) M) in iteration j, and M W_i in r
//   queue     spcbpt-fifo, an experiment: subspace i keeps its last M_0 vertices, R_i of the C_i
//             that all j iterations have put there: 1/M becomes C_i / (R_i j M) [eq 20, 21; without
//             the M_r in eq 20's denominator]. Biased, because C_i and R_i depend on the vertices
//             that are picked from: several of one subpath may lie in one subspace
//   MIS       paper: r = N Gamma beta / Q(i)                                  [eq 11, 12]
//             ris:   r = [ (1/(N Gamma)) (1/M + (1 - 1/M) Q(i)/beta) + (1 - 1/N)/M ]^-1, which
//             knows that there are only M subpaths; equals the paper's where beta << M Q(i)
//             Gamma, Q, trees: frozen since lacuna-train; Q = 0: not seen in training, see unseenQ
//   t = 1     never resampled;  s = 0 ordinary
//
// Without subspaces there is one of each, Gamma = 1, and Q comes from a warm-up that is thrown
// away: light vertices are picked in proportion to beta alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "libcore/base/parallel.h"
#include "libcore/methods/spcbpt.h"
#include "libcore/resampling/two_stages.h"
#include "libcore/subspace/gamma_table.h"
#include "libcore/subspace/subspace_labels.h"
#include "libcore/subspace/subspaces.h"
#include "libcore/subspace/training_settings.h"

namespace lacuna {

namespace {

constexpr std::uint32_t kLongestWindow = 32;  // iterations: bounds what is kept

/// Tables made of subspaces, to draw and to label with.
struct SubspaceTables {
    SubspaceTables(std::shared_ptr<const Subspaces> subspaces, const SubspaceOptions& options)
        : labels(subspaces),
          gamma(*subspaces),
          q(subspaces->q),
          unseen(unseenQ(q, subspaces->lightPaths)),
          windows(subspaces->lightCount, 1) {
        for (std::size_t i = 0; options.reuse > 0 && i < subspaces->population.size(); ++i) {
            const double each = subspaces->population[i] * double(options.subpaths);
            windows[i] = std::uint32_t(
                std::clamp(std::ceil(double(options.reuse) / each), 1.0, double(kLongestWindow)));
        }
    }

    bool measured() const { return !q.empty(); }
    void setQ(std::vector<double> measuredQ, std::uint64_t lightPaths) {
        q = std::move(measuredQ);
        unseen = unseenQ(q, lightPaths);
    }

    SubspaceLabels labels;
    GammaTable gamma;
    std::vector<double> q;  ///< by light subspace; 0 where no light subpath was seen
    double unseen;
    std::vector<std::uint32_t> windows;  ///< W_i: whole iterations whose vertices are kept
};

class SubspaceDensity final : public ConnectionDensity {
  public:
    SubspaceDensity(const SubspaceOptions& options, const SubspaceTables& tables)
        : subpaths_(double(options.subpaths)),
          picks_(options.picks.picks()),
          weights_(options.weights),
          tables_(tables) {}

    bool keepsLabels() const override { return true; }
    void labelWalk(std::span<PathVertex> walk) const override { tables_.labels.labelWalk(walk); }
    void labelEnds(std::span<OpenConnection> connections) const override {
        tables_.labels.labelEnds(connections);
    }

    /// Hits of lights in plain sight have little variance; a pick has more.
    SquaredLights squaredLights() const override {
        const bool papers = weights_ == SubspaceWeights::Paper;
        return papers ? SquaredLights::None : SquaredLights::Hittable;
    }

    double effectiveSamples(const Connection& c) const override {
        const auto beta = double(mean(c.beta));
        if (!(beta > 0.0)) return 0.0;  // never picked in stage 2
        const std::uint32_t i =
            tables_.labels.lightOf(*c.light.vertex, c.light.predecessor, c.light.label);
        const std::uint32_t j =
            tables_.labels.eyeOf(*c.eye.vertex, *c.eye.predecessor, c.eye.label);
        const double gamma = tables_.gamma.believed(i, j);
        if (!(gamma > 0.0)) return 0.0;
        const double q = tables_.q.empty() ? 0.0 : tables_.q[i], n = picks_.at(c.order);
        if (weights_ == SubspaceWeights::Paper)
            return n * gamma * beta / (q > 0.0 ? q : tables_.unseen);
        return twoStageSamples(subpaths_ * tables_.windows[i], n, gamma, beta, q);
    }

  private:
    double subpaths_;
    Picks picks_;
    SubspaceWeights weights_;
    const SubspaceTables& tables_;
};

class SubspaceConnections final : public Method {
  public:
    explicit SubspaceConnections(const SubspaceOptions& options)
        : options_(options),
          picks_(options.picks.picks()),
          tables_(std::make_shared<const Subspaces>(), options),
          density_(options, tables_) {}

    void use(const AssetSet& assets) override {
        const auto subspaces = assets.get<Subspaces>();
        if (!subspaces) return;
        tables_ = SubspaceTables(subspaces, options_);
        kept_.assign(tables_.windows.size(), {});
    }
    int warmupIterations() const override { return tables_.measured() ? 0 : 1; }
    PoolRequest pool() const override { return {options_.subpaths}; }
    Merging merging() const override { return options_.merging.merging(); }
    Sharing sharing() const override {
        // Every eye vertex may propose every light vertex: no column of Gamma has a zero.
        return {options_.sharedPixels};
    }

    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }

    void prepare(const LightPool& pool, IterationContext& context) override {
        const std::vector<std::uint32_t> labels = tables_.labels.lightOf(pool, context.threads);
        const std::size_t count = tables_.windows.size();
        cells_.resize(count);
        generated_.resize(count);
        fresh_.resize(count);
        ++iterations_;
        for (LightCell& cell : cells_) cell.members.clear();
        for (std::size_t n = 0; n < labels.size(); ++n) {
            cells_[labels[n]].members.push_back(pool.prefix(pool.connectable()[n]));
        }
        context.threads.forEach(count, [&](std::size_t i) {
            LightCell& cell = cells_[i];
            fresh_[i] = cell.members.size();
            generated_[i] += fresh_[i];
            for (const Kept& kept : kept_[i]) {
                for (std::size_t end = 0; const std::uint32_t length : kept.lengths) {
                    end += length;
                    cell.members.push_back({kept.vertices.data() + end - length, length});
                }
            }
            cell.iterations = double(kept_[i].size() + 1);
            if (options_.queue) {
                // The order of an iteration's subpaths is random: the first count as the youngest.
                cell.members.resize(std::min(cell.members.size(), std::size_t(options_.reuse)));
                cell.iterations = double(iterations_) * double(cell.members.size()) /
                                  double(std::max<std::uint64_t>(generated_[i], 1));
            }
            cell.makeTable();
        });
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        const std::uint32_t j =
            tables_.labels.eyeOf(context.vertex, context.predecessor(), context.vertex.asEye);
        std::array<double, Picks::kMost> storage;
        const auto numbers = std::span(storage).first(std::size_t(picks_.at(context.order())));
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            numbers[i] = rng.evenPick(std::uint32_t(i), std::uint32_t(numbers.size()));
        }
        pickInTwoStages(numbers, tables_.gamma.column(j), cells_,
                        double(numbers.size()) * double(options_.subpaths), sink);
    }

    bool learns() const override { return options_.reuse > 0; }
    bool sharesLightPaths() const override { return options_.reuse > 0; }

    void observe(const LightPool&, IterationContext& context) override {
        if (tables_.measured()) {
            if (options_.reuse > 0) keep(context.threads);
            return;
        }
        std::vector<double> q;
        for (const LightCell& cell : cells_) {
            q.push_back(cell.within.total() / double(options_.subpaths));
        }
        tables_.setQ(std::move(q), options_.subpaths);
    }

  private:
    /// Light subpaths of one iteration (queue: of all) that end in a subspace, one after the other.
    struct Kept {
        std::vector<PathVertex> vertices;
        std::vector<std::uint32_t> lengths;
    };
    /// Copies the light subpaths that the coming iterations use again. Iterations without a vertex
    /// count as well.
    void keep(const ThreadPool& threads) {
        threads.forEach(kept_.size(), [&](std::size_t i) {
            const std::uint32_t window = tables_.windows[i];
            const auto members = std::span<const Subpath>(cells_[i].members);
            if (options_.queue) {
                const Kept all = copyOf(members);  // some of them lie in what it replaces
                kept_[i].assign(1, all);
            } else if (window > 1) {
                kept_[i].push_back(copyOf(members.first(fresh_[i])));
                if (kept_[i].size() == window) kept_[i].pop_front();
            }
        });
    }

    static Kept copyOf(std::span<const Subpath> members) {
        Kept kept;
        for (const Subpath& y : members) {
            kept.vertices.insert(kept.vertices.end(), y.begin(), y.end());
            kept.lengths.push_back(std::uint32_t(y.size()));
        }
        return kept;
    }

    SubspaceOptions options_;
    Picks picks_;
    SubspaceTables tables_;
    SubspaceDensity density_;
    std::uint64_t iterations_ = 0;  // j, with the warm-up
    // By light subspace: LVC_i; how many of its members are of the pool (they come first); C_i, how many all iterations
    // so far have put there.
    std::vector<LightCell> cells_;
    std::vector<std::size_t> fresh_;
    std::vector<std::uint64_t> generated_;
    std::vector<std::deque<Kept>> kept_ = std::vector<std::deque<Kept>>(1);  // likewise
};

MethodRow subspaceRow(const std::string& name, const std::string& summary, bool biased,
                      const OptionTable<SubspaceOptions>& table) {
    return methodRow({.name = name,
                      .reference = "Su22",
                      .summary = summary,
                      .techniques = {.hits = true, .connects = true, .splats = true},
                      .emission = Emission::Learned,
                      .needs = {{"subspaces", "train.", trainingOptions().options()}},
                      .biased = biased,
                      .paper = {"first_connections=0", "deep_connections=0", "weights=paper",
                                "reuse=200", "emission=plain"}},
                     table, subspaceConnections);
}

}  // namespace

OptionTable<SubspaceOptions> subspaceOptions(const SubspaceOptions& defaults) {
    OptionTable<SubspaceOptions> table(defaults);
    table.integer("candidates", &SubspaceOptions::subpaths, 1, 1e8, "light subpaths",
                  "in the pool, M");
    table.include("", &SubspaceOptions::picks, pickOptions(defaults.picks, true));
    table.choice<SubspaceWeights>(
        "weights", &SubspaceOptions::weights,
        {{"ris", SubspaceWeights::Ris}, {"paper", SubspaceWeights::Paper}},
        "density that the weights use: resampling-aware, or the target alone (the paper)");
    return table;
}

std::unique_ptr<Method> subspaceConnections(const SubspaceOptions& options) {
    return std::make_unique<SubspaceConnections>(options);
}

MethodRow spcbptRow() {
    OptionTable<SubspaceOptions> table = subspaceOptions({});
    table.integer("reuse", &SubspaceOptions::reuse, 0, 1e6, "light vertices",
                  "kept per subspace across iterations, M_0; 0: none");
    table.include("", &SubspaceOptions::merging, mergeOptions());
    return subspaceRow(
        "spcbpt",
        "resamples light vertices in two stages, by trained subspaces of light and eye subpaths",
        false, table);
}

MethodRow spcbptFifoRow() {
    OptionTable<SubspaceOptions> table = subspaceOptions({.reuse = 200, .queue = true});
    table.integer("reuse", &SubspaceOptions::reuse, 1, 1e6, "light vertices",
                  "kept per subspace, M_0");
    return subspaceRow("spcbpt-fifo",
                       "spcbpt with the paper's queues of light vertices across iterations", true,
                       table);
}

}  // namespace lacuna

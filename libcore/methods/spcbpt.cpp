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
//             knows that one of M subpaths is not always there: the paper's where beta << M Q(i)
//             Gamma, Q, trees: frozen since lacuna-train; Q = 0: not seen there, see unseenQ
//   t = 1     never resampled;  s = 0 ordinary
//
// Without subspaces there is one of each, Gamma = 1, and Q comes from a warm-up that is thrown
// away: light vertices are picked in proportion to beta alone.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <numeric>

#include "libcore/base/alias_table.h"
#include "libcore/base/parallel.h"
#include "libcore/methods/registry.h"
#include "libcore/resampling/merge_options.h"
#include "libcore/resampling/picks.h"
#include "libcore/subspace/subspaces.h"
#include "libcore/subspace/training_settings.h"

namespace lacuna {

namespace {

constexpr std::size_t kEntriesPerTask = 4096;
constexpr std::uint32_t kLongestWindow = 32;  // iterations: bounds what is kept

enum class Weights { Ris, Paper };

struct Options {
    std::uint64_t subpaths = 100'000;  ///< M
    PickOptions picks = {.connections = 3, .first = 12, .deep = 1};
    Weights weights = Weights::Ris;
    std::uint64_t reuse = 0;  ///< M_0, 0: none
    bool queue = false;       ///< keep M_0 vertices, not whole iterations: biased
    MergeOptions merging = {};
};

/// Subspaces made ready to draw from and to label with.
class SubspaceTables {
  public:
    SubspaceTables(std::shared_ptr<const Subspaces> subspaces, const Options& options)
        : subspaces_(std::move(subspaces)), q_(subspaces_->q), windows_(lightCount(), 1) {
        for (std::size_t i = 0; options.reuse > 0 && i < subspaces_->population.size(); ++i) {
            const double each = subspaces_->population[i] * double(options.subpaths);
            windows_[i] = std::uint32_t(
                std::clamp(std::ceil(double(options.reuse) / each), 1.0, double(kLongestWindow)));
        }
        std::vector<double> weights;
        for (std::uint32_t j = 0; j < subspaces_->eyeCount; ++j) {
            const auto column = subspaces_->column(j);
            weights.assign(column.begin(), column.end());
            columns_.emplace_back(weights);
        }
        for (const float g : subspaces_->gamma) believedGamma_.push_back(rounded(g));
        unseen_ = unseenQ(q_, subspaces_->lightPaths);
    }

    bool measured() const { return !q_.empty(); }
    void setQ(std::vector<double> q, std::uint64_t lightPaths) {
        q_ = std::move(q);
        unseen_ = unseenQ(q_, lightPaths);
    }

    std::uint32_t lightCount() const { return subspaces_->lightCount; }
    /// The subspace of a light vertex, and that of an eye vertex: its label in that role, where it
    /// is known.
    std::uint32_t lightOf(const PathVertex& y, const PathVertex* predecessor, Label label) const {
        return label != kNone ? label : subspaces_->lightSubspace(y, predecessor);
    }
    std::uint32_t eyeOf(const PathVertex& z, const PathVertex& predecessor, Label label) const {
        return label != kNone ? label : subspaces_->eyeSubspace(z, predecessor);
    }
    /// To draw light subspaces from.
    const AliasTable& column(std::uint32_t eye) const { return columns_[eye]; }
    /// What the weights believe Gamma to be: within 0.4 %.
    double gamma(std::uint32_t light, std::uint32_t eye) const {
        const std::uint32_t high = believedGamma_[std::size_t(eye) * lightCount() + light];
        return double(std::bit_cast<float>(high << 16));
    }
    void labelWalk(std::span<PathVertex> walk) const {
        if (!walk.empty() && walk[0].kind != VertexKind::Lens) {
            walk[0].asLight = subspaces_->lightSubspace(walk[0], nullptr);
        }
        for (std::size_t first = 1; first < walk.size(); first += kTogether) {
            labelTogether(walk, first, std::min(walk.size(), first + kTogether));
        }
    }
    void labelEnds(std::span<OpenConnection> connections) const {
        for (std::size_t first = 0; first < connections.size(); first += kTogether) {
            labelEndsTogether(
                connections.subspan(first, std::min(kTogether, connections.size() - first)));
        }
    }
    /// 0 where no light subpath was seen.
    double q(std::uint32_t light) const { return q_.empty() ? 0.0 : q_[light]; }
    double unseen() const { return unseen_; }
    /// W_i: the whole iterations that the vertices of a light subspace are from.
    std::uint32_t window(std::uint32_t light) const { return windows_[light]; }

  private:
    static constexpr std::size_t kTogether = 8;  // vertices or connections: two descents each

    /// Look-ups that are taken in turn, and where their labels go.
    class Searches {
      public:
        void add(const DecisionTree& tree, const SubpathEnd& end, Label& label) {
            descents_[count_] = {tree, end};
            labels_[count_++] = &label;
        }
        void finish() {
            const auto descents = std::span(descents_).first(count_);
            lacuna::finish(descents);
            for (std::size_t i = 0; i < count_; ++i) *labels_[i] = descents[i].label();
        }

      private:
        std::array<DecisionTree::Descent, 2 * kTogether> descents_;
        std::array<Label*, 2 * kTogether> labels_;
        std::size_t count_ = 0;
    };

    /// Both labels of the vertices [begin, end) of a walk. The last one's in the other role waits
    /// for the vertex that it is connected with.
    void labelTogether(std::span<PathVertex> walk, std::size_t begin, std::size_t end) const {
        const bool eye = walk.front().kind == VertexKind::Lens;
        const DecisionTree& own = eye ? subspaces_->eyeTree : subspaces_->lightTree;
        const DecisionTree& other = eye ? subspaces_->lightTree : subspaces_->eyeTree;
        Searches searches;
        for (std::size_t i = begin; i < end; ++i) {
            PathVertex& v = walk[i];
            if (v.kind != VertexKind::Surface || !v.connectable()) continue;
            searches.add(own, subpathEnd(v, walk[i - 1]), eye ? v.asEye : v.asLight);
            if (i + 1 == walk.size()) continue;
            searches.add(other, subpathEnd(v, walk[i + 1]), eye ? v.asLight : v.asEye);
        }
        searches.finish();
    }

    /// Ends that no strategy has in their other role are left out: y_0, and what the lens sees.
    void labelEndsTogether(std::span<OpenConnection> connections) const {
        Searches searches;
        for (OpenConnection& c : connections) {
            const PathVertex &y = c.light.back(), &z = c.eye.back();
            if (c.light.size() > 1) {
                searches.add(subspaces_->eyeTree, subpathEnd(y, z), c.lightAsEye);
            }
            if (c.eye.size() > 2) {
                searches.add(subspaces_->lightTree, subpathEnd(z, y), c.eyeAsLight);
            }
        }
        searches.finish();
    }

    /// The upper half of a float, rounded to nearest; never zero for what is not.
    static std::uint16_t rounded(float g) {
        if (!(g > 0.0f)) return 0;
        return std::uint16_t(std::max(1u, (std::bit_cast<std::uint32_t>(g) + 0x8000u) >> 16));
    }

    std::shared_ptr<const Subspaces> subspaces_;
    std::vector<AliasTable> columns_;  // by eye subspace
    // Gamma in half the memory. Weights look it up for every technique of every path, at random,
    // and may believe what they like.
    std::vector<std::uint16_t> believedGamma_;
    std::vector<double> q_;
    std::vector<std::uint32_t> windows_;
    double unseen_ = 1.0;
};

class SubspaceDensity final : public ConnectionDensity {
  public:
    SubspaceDensity(const Options& options, const SubspaceTables& tables)
        : subpaths_(double(options.subpaths)),
          picks_(options.picks.picks()),
          weights_(options.weights),
          tables_(tables) {}

    bool keepsLabels() const override { return true; }
    void labelWalk(std::span<PathVertex> walk) const override { tables_.labelWalk(walk); }
    void labelEnds(std::span<OpenConnection> connections) const override {
        tables_.labelEnds(connections);
    }

    double effectiveSamples(const Connection& c) const override {
        const auto beta = double(mean(c.beta));
        if (!(beta > 0.0)) return 0.0;  // never picked in stage 2
        const std::uint32_t i =
            tables_.lightOf(*c.light.vertex, c.light.predecessor, c.light.label);
        const std::uint32_t j = tables_.eyeOf(*c.eye.vertex, *c.eye.predecessor, c.eye.label);
        const double gamma = tables_.gamma(i, j);
        if (!(gamma > 0.0)) return 0.0;
        const double q = tables_.q(i), n = picks_.at(c.order);
        const double m = subpaths_ * tables_.window(i);
        if (weights_ == Weights::Paper) return n * gamma * beta / (q > 0.0 ? q : tables_.unseen());
        // Both fractions of r brought to one: divisions cost as much as all the rest.
        return m * n * gamma * beta / (beta + (m - 1.0) * q + (n - 1.0) * gamma * beta);
    }

  private:
    double subpaths_;
    Picks picks_;
    Weights weights_;
    const SubspaceTables& tables_;
};

class SubspaceConnections final : public Method {
  public:
    explicit SubspaceConnections(const Options& options)
        : options_(options),
          picks_(options.picks.picks()),
          tables_(std::make_shared<const Subspaces>(), options),
          density_(options, tables_) {}

    void use(const AssetSet& assets) override {
        const auto subspaces = assets.get<Subspaces>();
        if (!subspaces) return;
        tables_ = SubspaceTables(subspaces, options_);
        kept_.assign(tables_.lightCount(), {});
    }
    int warmupIterations() const override { return tables_.measured() ? 0 : 1; }
    PoolRequest pool() const override { return {options_.subpaths}; }
    Merging merging() const override { return options_.merging.merging(); }

    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }

    void prepare(const LightPool& pool, IterationContext& context) override {
        const auto entries = pool.connectable();
        std::vector<std::uint32_t> labels(entries.size());
        context.threads.forEach(tasksFor(entries.size()), [&](std::size_t task) {
            const std::size_t begin = task * kEntriesPerTask;
            for (std::size_t n = begin; n < std::min(entries.size(), begin + kEntriesPerTask);
                 ++n) {
                const Subpath y = pool.prefix(entries[n]);
                const PathVertex* predecessor = y.size() > 1 ? &y[y.size() - 2] : nullptr;
                labels[n] = tables_.lightOf(y.back(), predecessor, y.back().asLight);
            }
        });
        const std::uint32_t count = tables_.lightCount();
        cells_.resize(count);
        ++iterations_;
        for (Cell& cell : cells_) cell.members.clear();
        for (std::size_t n = 0; n < entries.size(); ++n) {
            cells_[labels[n]].members.push_back(pool.prefix(entries[n]));
        }
        context.threads.forEach(count, [&](std::size_t i) {
            Cell& cell = cells_[i];
            cell.fresh = cell.members.size();
            cell.generated += cell.fresh;
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
                                  double(std::max<std::uint64_t>(cell.generated, 1));
            }
            std::vector<double> weights;
            for (const Subpath& y : cell.members) {
                weights.push_back(double(mean(y.back().throughput)));
            }
            cell.within = AliasTable(weights);
        });
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        const PathVertex& z = context.vertex;
        const AliasTable& column = tables_.column(tables_.eyeOf(z, context.predecessor(), z.asEye));
        // Every look into memory waits for the one before it, so the picks go side by side.
        struct Pick {
            double u, subspacePmf, pmf;
            const Cell* cell;
            const Subpath* light;
        };
        std::array<Pick, Picks::kMost> storage;  // not initialised: few of them are used
        const auto picks = std::span(storage).first(std::size_t(picks_.at(context.order())));
        for (std::size_t i = 0; i < picks.size(); ++i) {
            picks[i].u = rng.evenPick(std::uint32_t(i), std::uint32_t(picks.size()));
            column.prefetch(picks[i].u);
        }
        for (Pick& p : picks) {
            const AliasTable::Pick subspace = column.sample(p.u);
            p.cell = &cells_[subspace.index];
            p.subspacePmf = subspace.pmf;
            p.u = subspace.remapped;
            p.cell->within.prefetch(p.u);
        }
        for (Pick& p : picks) {
            p.light = nullptr;
            if (p.cell->within.empty()) continue;
            const AliasTable::Pick within = p.cell->within.sample(p.u);
            p.pmf = p.subspacePmf * within.pmf;
            p.light = &p.cell->members[within.index];
            __builtin_prefetch(p.light);
        }
        const double nm = double(picks_.at(context.order())) * double(options_.subpaths);
        for (const Pick& p : picks) {
            if (!p.light) continue;
            prefetch(p.light->back());
            sink.add({*p.light, 1.0 / (nm * p.cell->iterations * p.pmf), 0});
        }
    }

    bool learns() const override { return options_.reuse > 0; }
    bool sharesLightPaths() const override { return options_.reuse > 0; }

    void observe(const LightPool&, IterationContext& context) override {
        if (tables_.measured()) {
            if (options_.reuse > 0) keep(context.threads);
            return;
        }
        std::vector<double> q;
        for (const Cell& cell : cells_) {
            q.push_back(cell.within.total() / double(options_.subpaths));
        }
        tables_.setQ(std::move(q), options_.subpaths);
    }

  private:
    /// Prefixes of one iteration (queue: of all) that end in a subspace, one after the other.
    struct Kept {
        std::vector<PathVertex> vertices;
        std::vector<std::uint32_t> lengths;
    };
    /// A light subspace in this iteration: LVC_i.
    struct Cell {
        std::vector<Subpath> members;  ///< of the pool first, then the kept ones
        std::size_t fresh = 0;         ///< those of the pool
        std::uint64_t generated = 0;   ///< C_i: of all iterations so far
        double iterations = 1.0;       ///< that they stand for: min(j, W_i); queue: j R_i / C_i
        AliasTable within;             ///< P_r
    };

    /// Copies what the coming iterations use again. Iterations without a vertex count as well.
    void keep(const ThreadPool& threads) {
        threads.forEach(kept_.size(), [&](std::size_t i) {
            const std::uint32_t window = tables_.window(std::uint32_t(i));
            const auto members = std::span<const Subpath>(cells_[i].members);
            if (options_.queue) {
                const Kept all = copyOf(members);  // some of them lie in what it replaces
                kept_[i].assign(1, all);
            } else if (window > 1) {
                kept_[i].push_back(copyOf(members.first(cells_[i].fresh)));
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

    static std::size_t tasksFor(std::size_t entries) {
        return (entries + kEntriesPerTask - 1) / kEntriesPerTask;
    }

    Options options_;
    Picks picks_;
    SubspaceTables tables_;
    SubspaceDensity density_;
    std::uint64_t iterations_ = 0;                                           // j, with the warm-up
    std::vector<Cell> cells_;                                                // by light subspace
    std::vector<std::deque<Kept>> kept_ = std::vector<std::deque<Kept>>(1);  // likewise
};

/// All but `reuse`, which the two rows have in different ranges.
OptionTable<Options> subspaceOptions(const Options& defaults) {
    OptionTable<Options> table(defaults);
    table.integer("candidates", &Options::subpaths, 1, 1e8, "light subpaths", "in the pool, M");
    table.include("", &Options::picks, pickOptions(defaults.picks, true));
    table.choice<Weights>(
        "weights", &Options::weights, {{"ris", Weights::Ris}, {"paper", Weights::Paper}},
        "density that the weights see: resampling-aware, or the target alone (the paper)");
    return table;
}

MethodRow subspaceRow(const std::string& name, const std::string& summary, bool biased,
                      const OptionTable<Options>& table) {
    return methodRow({.name = name,
                      .reference = "Su22",
                      .summary = summary,
                      .techniques = {.hits = true, .connects = true, .splats = true},
                      .emission = Emission::Learned,
                      .needs = {{"subspaces", "train.", trainingOptions().options()}},
                      .biased = biased,
                      .paper = {"first_connections=0", "deep_connections=0", "weights=paper",
                                "reuse=200", "emission=plain"}},
                     table,
                     [](const Options& o) { return std::make_unique<SubspaceConnections>(o); });
}

}  // namespace

MethodRow spcbptRow() {
    OptionTable<Options> table = subspaceOptions({});
    table.integer("reuse", &Options::reuse, 0, 1e6, "light vertices",
                  "kept per subspace across iterations, M_0; 0: none");
    table.include("", &Options::merging, mergeOptions());
    return subspaceRow("spcbpt",
                       "light vertices resampled in two stages, by trained subspaces of light "
                       "subpaths",
                       false, table);
}

MethodRow spcbptFifoRow() {
    OptionTable<Options> table = subspaceOptions({.reuse = 200, .queue = true});
    table.integer("reuse", &Options::reuse, 1, 1e6, "light vertices", "kept per subspace, M_0");
    return subspaceRow("spcbpt-fifo",
                       "spcbpt with the paper's queues of light vertices across iterations", true,
                       table);
}

}  // namespace lacuna

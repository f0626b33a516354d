// Connections resampled at the nodes of the empty space's skeleton [Noel15]. See node_pmfs.h.
// (theory.md, "skelbpt")
//
//   pool      M = 1024 light subpaths, new in every iteration; L_s: their vertices y_{s-1}
//   pick      N vertices y per s (the paper: one) at the eye vertex's node:  contribution
//             h(y) / (M N P(y)) [eq 9]; at nodes that are not accepted, y comes evenly from L_s
//   lengths   N picks for every s [4.3], or for s > 2 a share of N on average (LengthPicks), which
//             then stands in the place of N
//   MIS       credit:  r is one constant, M (the authors' code)
//             aware:   r = [1/M + (1 - 1/M) / (N R)]^-1, R = max(w/Q_V, w/Q_U, 1/Q_C) / Z, after
//             [Nabata20a eq 14]. R is M P(y) for frozen means per node and s, from earlier
//             iterations: Q = (1/M) sum of the pmf's weights, Z the sum of maxima. Q_V counts
//             where the node's map of distances (sight_map.h) has V(n, y) = 1. Z would be exact
//             if the pmf were chosen by mass, and stands in for the even choice
//   s = 1     from the pool (y_0 is stored), or from next event; t = 1 is never resampled
#include <algorithm>

#include "libcore/methods/registry.h"
#include "libcore/resampling/node_pmfs.h"
#include "libcore/voxel/voxel_settings.h"

namespace lacuna {

namespace {

struct Options {
    std::uint64_t subpaths = 1024;  ///< M
    PickOptions picks = {.connections = 1, .first = 8};
    NodePmfs::Options nodes;
    Believed weights = Believed::Aware;
    Lengths lengths = Lengths::Share;
    bool nextEvent = false;
    Lamps lamps = Lamps::Seen;

    bool aware() const { return weights == Believed::Aware; }
    double credit() const { return double(subpaths); }
};

/// Frozen means of one node and length: Q of its pmfs, and Z.
struct Expected {
    /// Z of an iteration that has vertices is at least one. Means that count iterations without a
    /// vertex may be less (theory.md, "skelbpt").
    static constexpr double kLeastMaxima = 1e-3;

    double seen = 0, unseen = 0, uniform = 0, maxima = 0;
    std::uint64_t iterations = 0;

    void add(const Expected& now) {
        const double k = double(++iterations);
        seen += (now.seen - seen) / k;
        unseen += (now.unseen - unseen) / k;
        uniform += (now.uniform - uniform) / k;
        maxima += (now.maxima - maxima) / k;
    }
};
/// By node and s. The last row is for nodes without pmfs.
using ExpectedByNode = std::vector<std::vector<Expected>>;

class SkeletonDensity final : public ConnectionDensity {
  public:
    SkeletonDensity(const Options& options, const NodePmfs& nodes, const LengthPicks& picks,
                    const ExpectedByNode& expected)
        : options_(options), nodes_(nodes), picks_(picks), expected_(expected) {}

    std::optional<Constants> constants() const override {
        if (options_.aware() || options_.lengths != Lengths::Every) return std::nullopt;
        return Constants{options_.nextEvent ? 1.0 : options_.credit(), options_.credit()};
    }

    Lamps lamps() const override { return lampsOf(options_.nextEvent, options_.lamps); }
    bool keepsLabels() const override { return options_.aware() && nodes_.nodes() > 0; }
    void labelWalk(std::span<PathVertex> walk) const override {
        const bool eye = !walk.empty() && walk.front().kind == VertexKind::Lens;
        for (std::size_t i = 1; i < walk.size(); ++i) {
            PathVertex& v = walk[i];
            if (v.kind != VertexKind::Surface || !v.connectable()) continue;
            if (!eye && i + 1 == walk.size()) continue;  // has no predecessor yet
            const PathVertex& predecessor = walk[eye ? i - 1 : i + 1];
            v.asEye = nodes_.nodeOf(v, predecessor.position - v.position);
        }
    }
    void labelEnds(std::span<OpenConnection> connections) const override {
        for (OpenConnection& c : connections) {
            const PathVertex &y = c.light.back(), &z = c.eye.back();
            if (c.light.size() > 1) c.lightAsEye = nodes_.nodeOf(y, z.position - y.position);
        }
    }

    double effectiveSamples(const Connection& c) const override {
        if (options_.nextEvent && c.light.count == 1) return 1.0;
        const double chance = picks_.chance(c.light.count, c.order);
        return chance * (options_.aware() ? samplesAtNode(c) : options_.credit());
    }

  private:
    /// n r of the picks that are made at a node.
    double samplesAtNode(const Connection& c) const {
        const double picks = picks_.repeats(c.light.count, c.order);
        if (expected_.empty()) return picks;
        const PathVertex& z = *c.eye.vertex;
        const std::uint32_t node = c.eye.label != kNone
                                       ? c.eye.label
                                       : nodes_.nodeOf(z, c.eye.predecessor->position - z.position);
        const std::uint32_t slot = nodes_.slotOf(node);
        const std::vector<Expected>& row = slot == kNone ? expected_.back() : expected_[node];
        const auto s = std::size_t(c.light.count);
        // A length that was never seen: one sample per pick is as good a guess as any.
        if (s >= row.size() || !(row[s].uniform > 0.0)) return picks;
        const Expected& e = row[s];
        double ratio = 1.0 / e.uniform;
        if (slot != kNone) {
            const double w = nodes_.weight(node, *c.light.vertex, double(mean(c.beta)));
            const bool seen = options_.nodes.uses(NodePmfs::kSeen) && e.seen > 0.0 &&
                              nodes_.sees(slot, *c.light.vertex);
            if (seen) ratio = std::max(ratio, w / e.seen);
            if (e.unseen > 0.0) ratio = std::max(ratio, w / e.unseen);
            ratio /= std::max(e.maxima, Expected::kLeastMaxima);
        }
        const double perSubpath = 1.0 / double(options_.subpaths);
        return 1.0 / (perSubpath + (1.0 - perSubpath) / (picks * ratio));
    }

    const Options& options_;
    const NodePmfs& nodes_;
    const LengthPicks& picks_;
    const ExpectedByNode& expected_;
};

class SkeletonConnections final : public Method {
  public:
    explicit SkeletonConnections(const Options& options)
        : options_(options),
          picks_(options.lengths, options.picks.picks()),
          nodes_(options.nodes),
          density_(options_, nodes_, picks_, expected_) {}

    void use(const AssetSet& assets) override { nodes_.use(assets.get<Skeleton>()); }
    int warmupIterations() const override { return 1; }
    PoolRequest pool() const override { return {options_.subpaths}; }
    bool learns() const override { return options_.aware() || options_.lengths != Lengths::Every; }
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }

    void prepare(const LightPool& pool, IterationContext& context) override {
        vertices_.assign(pool, !options_.nextEvent);
        nodes_.prepare(vertices_, context);
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (options_.nextEvent) proposeFreshLight(context, options_.lamps, rng, sink);
        const PathVertex& z = context.vertex;
        const std::uint32_t slot =
            nodes_.slotOf(z.asEye != kNone ? z.asEye : nodes_.nodeOf(z, z.toPrevious));
        const auto m = double(options_.subpaths);
        picks_.forEachPick(vertices_, context.order(), rng, [&](int s, double u, double n) {
            if (slot == kNone) {
                const auto count = double(vertices_.count(s));
                const auto place = vertices_.begin(s) + std::size_t(u * count);
                sink.add({vertices_.prefix(place), count / (m * n), NodePmfs::kDistributions});
                return;
            }
            const CombinedPmf& pmf = nodes_.pmf(slot, s);
            if (pmf.empty()) return;
            const auto pick = pmf.sample(u);
            sink.add({vertices_.prefix(vertices_.begin(s) + pick.index), 1.0 / (m * pick.pmf * n),
                      pmf.owner(pick.index)});
        });
    }

    void observe(const LightPool&, IterationContext&) override {
        picks_.learn(vertices_);
        if (options_.aware()) learnExpected();
    }

  private:
    /// Updates the means that the coming iterations use.
    void learnExpected() {
        const auto m = double(options_.subpaths);
        expected_.resize(nodes_.nodes() + 1);
        const auto learn = [&](std::vector<Expected>& row, int s, const Expected& now) {
            if (row.size() <= std::size_t(s)) row.resize(std::size_t(s) + 1);
            row[std::size_t(s)].add(now);
        };
        for (int s = 1; s <= vertices_.lengths(); ++s) {
            const double share = double(vertices_.count(s)) / m;
            const auto accepted = nodes_.accepted();
            for (std::uint32_t slot = 0; slot < accepted.size(); ++slot) {
                const CombinedPmf& pmf = nodes_.pmf(slot, s);
                learn(expected_[accepted[slot]], s,
                      {pmf.sum(NodePmfs::kSeen) / m, pmf.sum(NodePmfs::kUnseen) / m, share,
                       pmf.maxima()});
            }
            learn(expected_.back(), s, {0.0, 0.0, share, 0.0});
        }
    }

    Options options_;
    LengthPicks picks_;
    NodePmfs nodes_;
    ExpectedByNode expected_;
    SkeletonDensity density_;
    VerticesByLength vertices_;
};

}  // namespace

MethodRow skelbptRow() {
    using Set = NodePmfs::Options::Set;
    OptionTable<Options> table;
    table.integer("candidates", &Options::subpaths, 1, 1e6, "light subpaths", "in the pool, M");
    table.include("", &Options::picks, pickOptions(Options{}.picks));
    table.real(
        "node_acceptance", [](auto& o) -> auto& { return o.nodes.acceptance; }, 0, 1e6, "",
        "a node has distributions if the number of its eye vertices is above this multiple of the "
        "mean");
    table.choice<Set>(
        "distributions", [](auto& o) -> auto& { return o.nodes.set; },
        {{"vuc", Set::Vuc}, {"uc", Set::Uc}, {"vc", Set::Vc}, {"c", Set::C}},
        "distributions of a node: visible (v), unoccluded (u), uniform (c)");
    addBelieved(table, &Options::weights);
    addLengths(table, &Options::lengths);
    addNextEvent(table, &Options::nextEvent, &Options::lamps);
    return methodRow(
        {.name = "skelbpt",
         .reference = "Noel15",
         .summary = "resamples light vertices at the nodes of the empty space's skeleton",
         .techniques = {.hits = true, .connects = true, .splats = true},
         .needs = {{"skeleton", "voxels.", voxelOptions().options()}},
         .proposalLabels = {"visible", "unoccluded", "uniform", "fallback"},
         .paper = {"first_connections=0", "weights=credit", "lengths=every", "lamps=power"}},
        table, [](Options o) {
            o.nodes.sight = o.aware();
            return std::make_unique<SkeletonConnections>(o);
        });
}

}  // namespace lacuna

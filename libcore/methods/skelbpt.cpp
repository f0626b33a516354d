// Connections resampled at the nodes of the empty space's skeleton [Noel15].
//
//   pool      M = 1024 light subpaths, new in every iteration; L_s: their vertices y_{s-1}
//   node      n(z): nearest node by geodesic distance (node_map.h), on the side the eye path is on
//   weight    w_n(y) = mean(beta(y)) / max(|P_n - y|, d)^2, at infinity mean(beta(y))   [eq 5]
//             d: a share of the ball's radius, because a light vertex may lie on the node
//   pmfs      over L_s, per node and s:  V ∝ w_n V(n, y) [eq 6],  U ∝ w_n [eq 7],
//             C = 1 / |L_s| [eq 8]
//             combined by the maximum heuristic, one of them chosen                 [4.3]
//   pick      N y per s (the paper: one):  contribution h(y) / (M N P(y))           [eq 9]
//   accepted  nodes that more than `node_acceptance` times the mean of all nodes' eye vertices are
//             mapped to [4.4]; at the others C alone. Counted by eye subpaths of their own over the
//             whole film before the first iteration, not by those of earlier iterations: a crop
//             sees the same nodes, and the first iteration has distributions as well
//   MIS       credit:  r is one constant, 1 <= r <= M (the authors' code: M)
//             aware:   r = [1/M + (1 - 1/M) / (N R)]^-1, R = max(w/Q_V, w/Q_U, 1/Q_C) / Z: what M
//             P(y) is for frozen means Q = (1/M) sum of the pmf's weights and Z of the sum of
//             maxima, all per node and s from earlier iterations; after [Nabata20a eq 14]. Q_V
//             counts where the node's map of distances (sight_map.h) has V(n, y) = 1; Z is exact
//             for the choice by mass and stands in for the even one
//   first     record_density > 0: the first eye vertex of a path is served by importance records on
//             surfaces instead (importance_records.h), the others by nodes [Noel15 6, outlook]
//   lengths   N for every s [4.3], or for s > 2 a share of N on average (LengthPicks), and divided
//             by that
//   s = 1     from the pool (y_0 is stored), or from next event; t = 1 is never resampled
#include <algorithm>
#include <cmath>
#include <optional>

#include "libcore/base/parallel.h"
#include "libcore/methods/importance_records.h"
#include "libcore/methods/length_pmfs.h"
#include "libcore/methods/methods.h"
#include "libcore/methods/sight_map.h"
#include "libcore/skeleton/node_map.h"

namespace lacuna {

namespace {

constexpr std::uint64_t kCountingPaths = 16384, kCountingPathsPerTask = 256;
constexpr std::size_t kVerticesPerTask = 512;
constexpr double kNearest = 0.1;    // of the ball's radius: the closest a light vertex counts as
constexpr int kEarlierRecords = 3;  // of the iteration before that tell a record its sums
constexpr std::uint32_t kUnmapped = NodeMap::kNone;
enum Row : std::uint32_t { kSeen, kUnseen, kUniform, kRows };
/// Label of the first of the records' distributions, after the nodes' and what has none.
constexpr std::uint32_t kRecordParts = kRows + 1;

struct Options {
    std::uint64_t subpaths;
    double acceptance, credit;
    bool use[kRows];
    Choice choice;
    bool nextEvent, aware, everyLength;
    Picks picks;  ///< N
    std::optional<ImportanceRecords::Options> firstRecords;
};

/// Nodes of both sides of a surface in one tag, so that the tag is a function of the vertex alone.
class NodeLookup {
  public:
    void use(std::shared_ptr<const Skeleton> skeleton) { skeleton_ = std::move(skeleton); }
    const Skeleton* skeleton() const { return skeleton_.get(); }

    std::uint32_t bothSides(const PathVertex& v) const {
        const Vec3d p(v.position), n(v.ng);
        return std::uint32_t(skeleton_->map.at(p, n)) | std::uint32_t(skeleton_->map.at(p, -n))
                                                            << 16;
    }
    /// Node of a vertex on the side where `direction` leaves it.
    std::uint32_t at(const PathVertex& v, Vec3 direction) const {
        if (!skeleton_) return kUnmapped;
        const std::uint32_t tag = v.tag != kNone ? v.tag : bothSides(v);
        return dot(v.ng, direction) < 0.0f ? tag >> 16 : tag & 0xffffu;
    }

  private:
    std::shared_ptr<const Skeleton> skeleton_;
};

double weightOf(const SkeletonNode& node, const PathVertex& y, double beta) {
    if (y.infinite()) return beta;
    const double d2 = lengthSquared(Vec3d(y.position) - node.position);
    const double least = kNearest * node.radius;
    return beta / std::max({d2, least * least, 1e-30});
}

/// Frozen means of one node and length.
struct Expected {
    double seen = 0, unseen = 0, uniform = 0, maxima = 0;
    std::uint64_t iterations = 0;
};

class SkeletonDensity final : public ConnectionDensity {
  public:
    /// `firstRecords`: null where nodes serve the first eye vertex as well.
    SkeletonDensity(const Options& options, const NodeLookup& lookup, const LengthPicks& picks,
                    const ImportanceRecords* firstRecords)
        : options_(options), lookup_(lookup), picks_(picks), firstRecords_(firstRecords) {}

    /// `expected` by node (the last row: where there is none) and s, `slot` by node, `sight` by
    /// slot.
    void freeze(const std::vector<std::vector<Expected>>* expected,
                const std::vector<std::uint32_t>* slot, const std::vector<SightMap>* sight) {
        expected_ = expected;
        slot_ = slot;
        sight_ = sight;
    }

    std::optional<Constants> constants() const override {
        if (options_.aware || !options_.everyLength) return std::nullopt;
        return Constants{options_.nextEvent ? 1.0 : options_.credit, options_.credit};
    }
    bool tagsVertices() const override {
        return options_.aware && (lookup_.skeleton() || firstRecords_);
    }
    /// First vertices of eye walks are tagged with their record, all others with their nodes.
    void tagWalk(std::span<PathVertex> walk) const override {
        const bool byRecord =
            firstRecords_ && !walk.empty() && walk.front().kind == VertexKind::Lens;
        for (std::size_t i = 1; i < walk.size(); ++i) {
            PathVertex& v = walk[i];
            if (v.kind != VertexKind::Surface || v.tag != kNone || !v.connectable()) continue;
            if (byRecord && connectionOrder(walk.first(i + 1)) == 1) {
                v.tag = firstRecords_->nearest(v);
            } else if (lookup_.skeleton()) {
                v.tag = lookup_.bothSides(v);
            }
        }
    }

    double effectiveSamples(const Connection& c) const override {
        if (options_.nextEvent && c.light.count == 1) return 1.0;
        const double chance = picks_.chance(c.light.count, c.order);
        if (!options_.aware) return chance * options_.credit;
        const bool byRecord = firstRecords_ && c.order == 1;
        return chance * (byRecord ? samplesByRecord(c) : samplesByNode(c));
    }

  private:
    double samplesByRecord(const Connection& c) const {
        // The tag is a record where the eye walk made the vertex, and a node where the light's did.
        const PathVertex& z = *c.eye.vertex;
        const std::uint32_t serving = c.eye.maker == EdgeMaker::EyeWalk ? firstRecords_->serving(z)
                                                                        : firstRecords_->nearest(z);
        return firstRecords_->samplesOf(c, serving, picks_.repeats(c.light.count, c.order));
    }
    /// r of the picks that are made.
    double samplesByNode(const Connection& c) const {
        const auto m = double(options_.subpaths);
        const PathVertex& z = *c.eye.vertex;
        const Vec3 back = c.eye.predecessor->position - z.position;
        std::uint32_t node = lookup_.at(z, back);
        const double picks = picks_.repeats(c.light.count, c.order);
        if (expected_->empty()) return picks;
        const std::size_t nodes = expected_->size() - 1;
        const std::uint32_t slot = node < nodes ? (*slot_)[node] : kNone;
        if (slot == kNone) node = std::uint32_t(nodes);
        const std::vector<Expected>& row = (*expected_)[node];
        const auto s = std::size_t(c.light.count);
        // A length that was never seen: one sample per pick is as good a guess as any.
        if (s >= row.size() || !(row[s].uniform > 0.0)) return picks;
        const Expected& e = row[s];
        double ratio = 1.0 / e.uniform;
        if (node < nodes) {
            const double w =
                weightOf(lookup_.skeleton()->nodes[node], *c.light.vertex, double(mean(c.beta)));
            ratio = options_.use[kUniform] ? ratio : 0.0;
            if (options_.use[kSeen] && e.seen > 0.0 && (*sight_)[slot].sees(*c.light.vertex))
                ratio = std::max(ratio, w / e.seen);
            if (options_.use[kUnseen] && e.unseen > 0.0) ratio = std::max(ratio, w / e.unseen);
            ratio /= std::max(e.maxima, 1e-3);
        }
        return ratio > 0.0 ? 1.0 / (1.0 / m + (1.0 - 1.0 / m) / (picks * ratio)) : 1.0 / m;
    }

    const Options& options_;
    const NodeLookup& lookup_;
    const LengthPicks& picks_;
    const ImportanceRecords* firstRecords_;
    const std::vector<std::vector<Expected>>* expected_ = nullptr;
    const std::vector<std::uint32_t>* slot_ = nullptr;
    const std::vector<SightMap>* sight_ = nullptr;
};

class SkeletonConnections final : public Method {
  public:
    explicit SkeletonConnections(const Options& options)
        : options_(options),
          picks_(options.everyLength, options.picks),
          firstRecords_(options.firstRecords),
          density_(options_, lookup_, picks_, firstRecords_ ? &*firstRecords_ : nullptr) {}

    void useSkeleton(std::shared_ptr<const Skeleton> skeleton) override {
        lookup_.use(std::move(skeleton));
    }
    int warmupIterations() const override {
        return firstRecords_ ? ImportanceRecords::kWarmupIterations : 1;
    }
    PoolRequest pool() const override { return {options_.subpaths}; }
    bool learns() const override {
        return options_.aware || !options_.everyLength || firstRecords_;
    }

    const ConnectionDensity& freeze(std::uint32_t) override {
        density_.freeze(&expected_, &slot_, &sight_);
        return density_;
    }

    void prepare(const LightPool& pool, IterationContext& context) override {
        if (slot_.empty()) {
            countEyeVertices(context);
            if (options_.aware && options_.use[kSeen]) lookAround(context);
        }
        vertices_.assign(pool, !options_.nextEvent);
        if (firstRecords_) firstRecords_->prepare(vertices_, context);
        const std::size_t n = vertices_.size();
        const auto lengths = std::size_t(vertices_.lengths()) + 1;
        found_.assign(used_.size() * lengths, {});
        pmfs_.assign(used_.size() * lengths, {});
        std::vector<double> seen(used_.size() * n), unseen(used_.size() * n);
        const std::vector<double> ones(n, 1.0);
        {
            PhaseTimer timer(context.statistics, "node visibility");
            const std::size_t tasksPerNode = (n + kVerticesPerTask - 1) / kVerticesPerTask;
            std::vector<RayTally> tallies(used_.size() * tasksPerNode);
            context.threads.forEach(tallies.size(), [&](std::size_t task) {
                const std::size_t u = task / tasksPerNode,
                                  first = task % tasksPerNode * kVerticesPerTask;
                const SkeletonNode& node = lookup_.skeleton()->nodes[used_[u]];
                PathVertex at;
                at.kind = VertexKind::Lens;  // a point without a surface
                at.position = Vec3(node.position);
                for (std::size_t i = first; i < std::min(n, first + kVerticesPerTask); ++i) {
                    const PathVertex& y = vertices_.prefix(i).back();
                    const double w = weightOf(node, y, double(mean(y.throughput)));
                    unseen[u * n + i] = w;
                    if (w > 0.0 && options_.use[kSeen] &&
                        context.space.visible(y, at, tallies[task])) {
                        seen[u * n + i] = w;
                    }
                }
            });
            for (const RayTally& t : tallies) context.statistics.add(t);
        }
        PhaseTimer timer(context.statistics, "node distributions");
        context.threads.forEach(pmfs_.size(), [&](std::size_t i) {
            const std::size_t u = i / lengths, s = i % lengths;
            if (s == 0) return;
            const std::size_t from = vertices_.begin(int(s)), count = vertices_.count(int(s));
            std::vector<std::span<const double>> rows(kRows);
            const std::vector<double> none(count, 0.0);
            const auto part = [&](const std::vector<double>& all, std::size_t at, Row row) {
                rows[row] = options_.use[row] ? std::span(all).subspan(at, count) : std::span(none);
            };
            part(seen, u * n + from, kSeen);
            part(unseen, u * n + from, kUnseen);
            part(ones, from, kUniform);
            pmfs_[i] = CombinedPmf(rows, options_.choice);
            const auto m = double(options_.subpaths);
            found_[i] = {pmfs_[i].sum(kSeen) / m, pmfs_[i].sum(kUnseen) / m, double(count) / m,
                         pmfs_[i].maxima(), 0};
        });
        context.statistics.hold("distribution bytes", bytesOf(pmfs_));
        context.statistics.hold("nodes", slot_.size());
        context.statistics.hold("nodes with distributions", used_.size());
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (options_.nextEvent) proposeFreshLight(context, rng, sink);
        if (firstRecords_ && context.order() == 1) {
            selectByRecord(context, rng, sink);
        } else {
            selectByNode(context, rng, sink);
        }
    }

    void observe(const LightPool&, IterationContext& context) override {
        picks_.learn(vertices_);
        if (firstRecords_) firstRecords_->observe(context);
        if (options_.aware) learnExpected();
    }

  private:
    void selectByRecord(const EyeContext& context, Rng& rng, ProposalSink& sink) const {
        const std::uint32_t serving = firstRecords_->serving(context.vertex);
        const auto m = double(options_.subpaths);
        picks_.forEachPick(vertices_, 1, rng, [&](int s, double u, double n) {
            const ImportanceRecords::Pick pick = firstRecords_->pick(serving, s, u, rng);
            sink.add({vertices_.prefix(pick.place), 1.0 / (m * n * pick.probability),
                      kRecordParts + pick.label});
        });
    }

    void selectByNode(const EyeContext& context, Rng& rng, ProposalSink& sink) const {
        const std::uint32_t node = lookup_.at(context.vertex, context.vertex.toPrevious);
        const std::uint32_t slot = node < slot_.size() ? slot_[node] : kNone;
        const auto lengths = std::size_t(vertices_.lengths()) + 1;
        const auto m = double(options_.subpaths);
        picks_.forEachPick(vertices_, context.order(), rng, [&](int s, double u, double n) {
            if (slot == kNone) {
                const auto count = double(vertices_.count(s));
                const auto place = vertices_.begin(s) + std::size_t(u * count);
                sink.add({vertices_.prefix(place), count / (m * n), kRows});
                return;
            }
            const CombinedPmf& pmf = pmfs_[slot * lengths + std::size_t(s)];
            if (pmf.empty()) return;
            const auto pick = pmf.sample(u);
            sink.add({vertices_.prefix(vertices_.begin(s) + pick.index), 1.0 / (m * pick.pmf * n),
                      pmf.owner(pick.index)});
        });
    }

    /// Frozen means of the coming iterations.
    void learnExpected() {
        const auto lengths = std::size_t(vertices_.lengths()) + 1;
        expected_.resize(slot_.size() + 1);
        const auto learn = [&](std::size_t node, std::size_t s, const Expected& now) {
            std::vector<Expected>& row = expected_[node];
            if (row.size() <= s) row.resize(s + 1);
            Expected& e = row[s];
            const double k = double(++e.iterations);
            e.seen += (now.seen - e.seen) / k;
            e.unseen += (now.unseen - e.unseen) / k;
            e.uniform += (now.uniform - e.uniform) / k;
            e.maxima += (now.maxima - e.maxima) / k;
        };
        for (std::size_t s = 1; s < lengths; ++s) {
            for (std::size_t u = 0; u < used_.size(); ++u)
                learn(used_[u], s, found_[u * lengths + s]);
            Expected share;
            share.uniform = double(vertices_.count(int(s))) / double(options_.subpaths);
            learn(slot_.size(), s, share);
        }
    }

    /// Which nodes are worth distributions: those that many eye vertices are mapped to.
    void countEyeVertices(IterationContext& context) {
        const std::size_t nodes = lookup_.skeleton() ? lookup_.skeleton()->nodes.size() : 0;
        slot_.assign(nodes, kNone);
        if (nodes == 0) return;
        constexpr std::uint64_t kTasks = kCountingPaths / kCountingPathsPerTask;
        std::vector<std::vector<std::uint32_t>> counts(kTasks);
        std::vector<RayTally> tallies(kTasks);
        context.threads.forEach(kTasks, [&](std::size_t task) {
            counts[task].assign(nodes, 0);
            std::vector<PathVertex> path;
            for (std::uint64_t i = 0; i < kCountingPathsPerTask; ++i) {
                Rng rng(context.seed, 0, StreamKind::CachePath, task * kCountingPathsPerTask + i);
                context.space.traceEye(rng, tallies[task], path);
                for (const PathVertex& v : path) {
                    if (v.kind != VertexKind::Surface || !v.connectable()) continue;
                    const std::uint32_t node = lookup_.at(v, v.toPrevious);
                    if (node < nodes) ++counts[task][node];
                }
            }
        });
        for (const RayTally& t : tallies) context.statistics.add(t);
        std::vector<std::uint64_t> hits(nodes, 0);
        std::uint64_t all = 0;
        for (const auto& part : counts) {
            for (std::size_t n = 0; n < nodes; ++n) {
                hits[n] += part[n];
                all += part[n];
            }
        }
        for (std::uint32_t n = 0; n < nodes; ++n) {
            if (double(hits[n]) * double(nodes) <= options_.acceptance * double(all)) continue;
            slot_[n] = std::uint32_t(used_.size());
            used_.push_back(n);
        }
    }

    /// What the accepted nodes see; the same for the whole render.
    void lookAround(IterationContext& context) {
        PhaseTimer timer(context.statistics, "node sight");
        sight_.resize(used_.size());
        std::vector<RayTally> tallies(used_.size());
        context.threads.forEach(used_.size(), [&](std::size_t u) {
            const Vec3 position(lookup_.skeleton()->nodes[used_[u]].position);
            sight_[u] = SightMap(position, context.space, tallies[u]);
        });
        for (const RayTally& t : tallies) context.statistics.add(t);
        std::uint64_t bytes = 0;
        for (const SightMap& map : sight_) bytes += map.bytes();
        context.statistics.hold("sight map bytes", bytes);
    }

    Options options_;
    NodeLookup lookup_;
    LengthPicks picks_;
    std::optional<ImportanceRecords> firstRecords_;
    SkeletonDensity density_;
    std::vector<std::uint32_t> slot_;  // by node: place in used_, kNone where not accepted
    std::vector<std::uint32_t> used_;  // accepted nodes
    std::vector<SightMap> sight_;      // by slot
    VerticesByLength vertices_;
    std::vector<CombinedPmf> pmfs_;                // by slot and s
    std::vector<Expected> found_;                  // likewise, of this iteration
    std::vector<std::vector<Expected>> expected_;  // by node and s, of earlier iterations
};

}  // namespace

MethodRow skeletonRow() {
    using Kind = Parameter::Kind;
    MethodRow row;
    row.name = "skelbpt";
    row.reference = "Noel15";
    row.summary = "light vertices resampled at the nodes of the empty space's skeleton";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.needsSkeleton = true;
    row.parts = {"visible",     "unoccluded",        "uniform",        "fallback",
                 "record_full", "record_unoccluded", "record_bounded", "record_uniform"};
    row.parameters = {
        lightPathsParameter(),
        {"candidates", Kind::Integer, 1024, 1, 1e6, "light subpaths in the pool, N"},
        connectionsParameter(1),
        firstConnectionsParameter(8),
        {"node_acceptance", Kind::Real, 1, 0, 1e6,
         "nodes with at most so many times the mean number of eye vertices get no distributions"},
        {"distributions",
         Kind::Choice,
         0,
         0,
         3,
         "which of visible (v), unoccluded (u) and uniform (c) there are at a node",
         {"vuc", "uc", "vc", "c"}},
        {"choice",
         Kind::Choice,
         0,
         0,
         1,
         "how one of a node's distributions is chosen: evenly, or by what is its own of the pool",
         {"even", "mass"}},
        {"weights",
         Kind::Choice,
         1,
         0,
         1,
         "what the weights believe: credit samples per connection (the paper), or the resampling",
         {"credit", "aware"}},
        {"credit",
         Kind::Real,
         0,
         0,
         1e6,
         "samples that a connection counts as; 0: all candidates",
         {},
         "candidates"},
        lengthsParameter(),
        {"voxels.resolution", Kind::Integer, 128, 8, 1024,
         "voxels along the longest side of the skeleton's cache"},
        {"record_density", Kind::Real, 0, 0, 16,
         "eye subpaths that leave an importance record for first eye vertices, per pixel; 0: nodes "
         "serve them as well"},
        {"records", Kind::Integer, 3, 1, 16, "records that serve a first eye vertex"},
        nextEventParameter(false),
        presetParameter()};
    row.paper = {{"first_connections", 0}, {"weights", 0}, {"lengths", 0}};
    row.create = [](const Settings& s) {
        Options o;
        o.subpaths = s.integer("candidates");
        o.acceptance = s.real("node_acceptance");
        o.credit = s.real("credit") > 0.0 ? s.real("credit") : double(o.subpaths);
        const std::uint64_t d = s.integer("distributions");
        o.use[kSeen] = d == 0 || d == 2;
        o.use[kUnseen] = d <= 1;
        o.use[kUniform] = true;
        o.choice = s.integer("choice") == 0 ? Choice::Even : Choice::Mass;
        o.aware = s.integer("weights") == 1;
        o.picks = picksOf(s);
        o.everyLength = s.integer("lengths") == 0;
        o.nextEvent = s.on("next_event");
        if (s.real("record_density") > 0.0) {
            o.firstRecords = {
                o.subpaths, s.real("record_density"), int(s.integer("records")), kEarlierRecords,
                o.aware,    CachePoints::Which::First};
        }
        return std::make_unique<SkeletonConnections>(o);
    };
    return row;
}

}  // namespace lacuna

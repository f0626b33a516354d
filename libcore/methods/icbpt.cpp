// Importance caching [Georgiev12] adapted to bidirectional path tracing as [Noel15 5] compares with
// it: light vertices resampled at importance records on surfaces.
//
//   pool      M = 1024 light subpaths, new in every iteration; L_s: their vertices y_{s-1}
//   records   vertices of record_density x pixels eye subpaths that add nothing to the image, new
//             in every iteration (cache_points.h); `records` = 3 of them serve an eye vertex
//   pmfs      over L_s, per record c and s:  F ∝ w_F = beta rho rho_c G V (full contribution),
//             U the same without V, B the same without V and rho_c and with G bounded by what it is
//             at four times the distance to the records around, C = 1 / |L_s|
//             combined by the maximum heuristic, one of them chosen evenly (length_pmfs.h)
//   pick      N y per s (the paper: one), each from one of the records evenly; divided by the
//             mixture's probability:  contribution h(y) / (M N Pbar(y)),
//             Pbar = mean of P_c(y) over the records
//   lengths   N for every s; or for s > 2 a share of N on average (LengthPicks), and divided by
//             that
//   MIS       credit:  r is one constant, 1 <= r <= M
//             aware:   r = mean over the records of [1/M + (1 - 1/M) / (N R_c)]^-1,
//             R_c = max over the four of (w/Q) / Z: what M P_c(y) is for frozen means
//             Q = (1/M) sum of w and Z of the sum of maxima, per record and s from the earlier
//             iteration, with V = 1 and rho at the eye vertex; after [Nabata20a eq 14];
//             then withEyeShare
//   s = 1     from the pool, or from next event; t = 1 is never resampled
#include <algorithm>

#include "libcore/base/parallel.h"
#include "libcore/methods/cache_points.h"
#include "libcore/methods/length_pmfs.h"
#include "libcore/methods/methods.h"

namespace lacuna {

namespace {

/// G falls with the square of the distance: four times as far is a sixteenth.
constexpr double kBoundedShare = 1.0 / 16.0;
enum Row : std::uint32_t { kFull, kUnoccluded, kBounded, kUniform, kRows };

/// What weights read of a record and a length, in this order: Q of the four, and Z.
constexpr int kColumns = kRows + 1;
constexpr std::uint32_t kMaxima = kRows;
/// Longer light subpaths are believed to be what those of this length are.
constexpr int kLengths = 8;

struct Options {
    std::uint64_t subpaths;
    double density, credit, eyeShare;
    int records;
    bool nextEvent, aware, everyLength;
    Picks picks;   ///< N
    int qRecords;  ///< N_q
};

/// n r of a connection; frozen for an iteration.
class RecordDensity final : public ConnectionDensity {
  public:
    RecordDensity(const Options& options, const LengthPicks& picks)
        : options_(options), picks_(picks) {}

    /// `learnt`: kColumns values per record and length.
    void freeze(const CachePoints& records, std::span<const double> learnt) {
        records_ = &records;
        learnt_ = learnt;
    }

    std::optional<Constants> constants() const override {
        if (options_.aware || !options_.everyLength) return std::nullopt;
        return Constants{options_.nextEvent ? 1.0 : options_.credit, options_.credit};
    }
    bool tagsVertices() const override { return options_.aware; }
    std::uint32_t tagOf(const PathVertex& vertex) const override {
        return records_->nearest(vertex.position);
    }

    double effectiveSamples(const Connection& c) const override {
        if (options_.nextEvent && c.light.count == 1) return 1.0;
        const double chance = picks_.chance(c.light.count, c.order);
        return chance * (options_.aware ? samplesOf(c) : options_.credit);
    }

  private:
    /// r of the picks that are made.
    double samplesOf(const Connection& c) const {
        const auto around = records_->around(records_->serving(*c.eye.vertex));
        const double picks = picks_.repeats(c.light.count, c.order);
        if (around.empty()) return picks;
        const auto perSubpath = 1.0 / double(options_.subpaths);
        const Rgb arriving = c.beta * c.light.scatter;
        const double flow = double(mean(arriving));
        const double through = double(mean(arriving * c.eye.scatter));
        const int length = std::min(c.light.count, kLengths) - 1;
        double sum = 0.0;
        for (const std::uint32_t i : around) {
            const double* q =
                &learnt_[(std::size_t(i) * kLengths + std::size_t(length)) * kColumns];
            // A length that was never seen: one sample per pick is as good a guess as any.
            if (!(q[kUniform] > 0.0)) {
                sum += picks;
                continue;
            }
            const double g = records_->trustedGeometry(i, *c.light.vertex, c.geometry);
            const double bounded = std::min(g, kBoundedShare * records_->geometryLimit(i));
            double ratio = 1.0 / q[kUniform];
            if (q[kFull] > 0.0) ratio = std::max(ratio, through * g / q[kFull]);
            if (q[kUnoccluded] > 0.0) ratio = std::max(ratio, through * g / q[kUnoccluded]);
            if (q[kBounded] > 0.0) ratio = std::max(ratio, flow * bounded / q[kBounded]);
            ratio /= q[kMaxima];
            sum += 1.0 / (perSubpath + (1.0 - perSubpath) / (picks * ratio));
        }
        return withEyeShare(sum / double(around.size()), c.order, options_.eyeShare);
    }

    Options options_;
    const LengthPicks& picks_;
    const CachePoints* records_ = nullptr;
    std::span<const double> learnt_;
};

class ImportanceCaching final : public Method {
  public:
    explicit ImportanceCaching(const Options& options)
        : options_(options),
          picks_(options.everyLength, options.picks),
          density_(options, picks_),
          earlier_(kLengths * kColumns, 1, options.qRecords) {}

    // The first leaves records, the second finds their sums.
    int warmupIterations() const override { return 2; }
    PoolRequest pool() const override { return {options_.subpaths}; }
    bool learns() const override { return true; }

    const ConnectionDensity& freeze(std::uint32_t) override {
        density_.freeze(records_, learnt_);
        return density_;
    }

    void prepare(const LightPool& pool, IterationContext& context) override {
        PhaseTimer timer(context.statistics, "record distributions");
        vertices_.assign(pool, !options_.nextEvent);
        const auto lengths = std::size_t(vertices_.lengths()) + 1;
        pmfs_.assign(records_.size() * lengths, {});
        found_.assign(records_.size() * kLengths * kColumns, 0.0);
        std::vector<RayTally> tallies(records_.size());
        context.threads.forEach(records_.size(), [&](std::size_t r) {
            std::vector<double> weight[kRows];
            for (auto& w : weight) w.assign(vertices_.size(), 0.0);
            weigh(std::uint32_t(r), context.space, tallies[r], weight);
            for (std::size_t s = 1; s < lengths; ++s) {
                std::span<const double> rows[kRows];
                for (std::size_t i = 0; i < kRows; ++i) {
                    rows[i] = std::span(weight[i]).subspan(vertices_.begin(int(s)),
                                                           vertices_.count(int(s)));
                }
                const CombinedPmf& pmf = pmfs_[r * lengths + s] = CombinedPmf(rows, Choice::Even);
                if (s > kLengths) continue;
                double* found = &found_[(r * kLengths + s - 1) * kColumns];
                for (std::size_t i = 0; i < kRows; ++i) {
                    found[i] = pmf.sum(i) / double(options_.subpaths);
                }
                found[kMaxima] = pmf.maxima();
            }
        });
        for (const RayTally& t : tallies) context.statistics.add(t);
        context.statistics.hold("distribution bytes", bytesOf(pmfs_));
        context.statistics.hold("importance records", records_.size());
        context.statistics.hold("importance record bytes", records_.bytes());
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (options_.nextEvent) proposeFreshLight(context, rng, sink);
        const auto around = records_.around(records_.serving(context.vertex));
        const auto lengths = std::size_t(vertices_.lengths()) + 1;
        const auto m = double(options_.subpaths);
        picks_.forEachPick(vertices_, context.order(), rng, [&](int s, double u, double n) {
            if (around.empty()) {
                const auto count = double(vertices_.count(s));
                const auto place = vertices_.begin(s) + std::size_t(u * count);
                sink.add({vertices_.prefix(place), count / (m * n), kRows});
                return;
            }
            const auto pmfOf = [&](std::uint32_t record) -> const CombinedPmf& {
                return pmfs_[record * lengths + std::size_t(s)];
            };
            // No pmf is empty: uniform is always one of the four.
            const CombinedPmf& chosen = pmfOf(around[rng.below(std::uint32_t(around.size()))]);
            const std::uint32_t index = chosen.sample(u).index;
            double sum = 0.0;
            for (const std::uint32_t record : around) sum += pmfOf(record).pmf(index);
            sink.add({vertices_.prefix(vertices_.begin(s) + index),
                      double(around.size()) / (m * sum * n), chosen.owner(index)});
        });
    }

    void observe(const LightPool&, IterationContext& context) override {
        PhaseTimer timer(context.statistics, "importance records");
        picks_.learn(vertices_);
        CachePoints next(context, options_.density, options_.records, generation_++);
        if (options_.aware) {
            earlier_.add(std::move(records_), std::move(found_));
            learnt_ = earlier_.at(next, context.threads);
        }
        records_ = std::move(next);
    }

  private:
    /// Fills the four rows for all vertices; `weight` holds zeros.
    void weigh(std::uint32_t record, const PathSpace& space, RayTally& tally,
               std::vector<double> (&weight)[kRows]) const {
        const Subpath eye = records_.eye(record);
        const double limit = records_.geometryLimit(record);
        for (std::size_t i = 0; i < vertices_.size(); ++i) {
            weight[kUniform][i] = 1.0;
            const Subpath light = vertices_.prefix(i);
            const PathSpace::Arrival arriving = space.arrival(light, eye, false);
            const double flow = double(mean(arriving.value));
            if (!(flow > 0.0)) continue;
            weight[kBounded][i] = flow * std::min(arriving.geometry, kBoundedShare * limit);
            const PathSpace::Arrival scattered = space.arrival(light, eye, true);
            const double full = double(mean(scattered.value)) * std::min(arriving.geometry, limit);
            weight[kUnoccluded][i] = full;
            if (full > 0.0 && space.visible(light.back(), eye.back(), tally)) {
                weight[kFull][i] = full;
            }
        }
    }

    Options options_;
    LengthPicks picks_;
    RecordDensity density_;
    CachePoints records_;         // of this iteration
    std::vector<double> learnt_;  // by record, length and column, from the earlier iteration
    EarlierValues earlier_;
    std::uint32_t generation_ = 0;
    VerticesByLength vertices_;
    std::vector<CombinedPmf> pmfs_;  // by record and s
    std::vector<double> found_;      // as learnt_, of this iteration
};

}  // namespace

MethodRow importanceCachingRow() {
    using Kind = Parameter::Kind;
    MethodRow row;
    row.name = "icbpt";
    row.reference = "Georgiev12";
    row.summary = "light vertices resampled at importance records on surfaces";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.parts = {"full", "unoccluded", "bounded", "uniform", "fallback"};
    row.parameters = {lightPathsParameter(),
                      {"candidates", Kind::Integer, 1024, 1, 1e6, "light subpaths in the pool, N"},
                      connectionsParameter(1),
                      firstConnectionsParameter(8),
                      {"record_density", Kind::Real, 0.001, 0, 16,
                       "eye subpaths that leave importance records, per pixel"},
                      {"records", Kind::Integer, 3, 1, 16, "records that serve an eye vertex"},
                      {"weights",
                       Kind::Choice,
                       1,
                       0,
                       1,
                       "what the weights believe: credit samples per connection, or the resampling",
                       {"credit", "aware"}},
                      {"q_records", Kind::Integer, 3, 1, 16,
                       "records of the iteration before that tell a record its sums, N_q"},
                      {"credit",
                       Kind::Real,
                       0,
                       0,
                       1e6,
                       "samples that a connection counts as; 0: all candidates",
                       {},
                       "candidates"},
                      lengthsParameter(),
                      eyeShareParameter(0.25),
                      nextEventParameter(false),
                      presetParameter()};
    row.paper = {{"eye_share", 0}, {"first_connections", 0}, {"lengths", 0}, {"weights", 0}};
    row.create = [](const Settings& s) {
        Options o;
        o.subpaths = s.integer("candidates");
        o.density = s.real("record_density");
        o.records = int(s.integer("records"));
        o.credit = s.real("credit") > 0.0 ? s.real("credit") : double(o.subpaths);
        o.eyeShare = s.real("eye_share");
        o.nextEvent = s.on("next_event");
        o.aware = s.integer("weights") == 1;
        o.everyLength = s.integer("lengths") == 0;
        o.picks = picksOf(s);
        o.qRecords = int(s.integer("q_records"));
        return std::make_unique<ImportanceCaching>(o);
    };
    return row;
}

}  // namespace lacuna

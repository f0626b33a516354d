// Importance caching [Georgiev12] adapted to bidirectional path tracing as [Noel15 5] compares with
// it: light vertices resampled at importance records on surfaces (importance_records.h).
//
//   pool      M = 1024 light subpaths, new in every iteration; L_s: their vertices y_{s-1}
//   records   vertices of record_density x pixels eye subpaths; `records` = 3 of them serve an eye
//             vertex
//   pick      N y per s (the paper: one), divided by M N Pbar(y)
//   lengths   N for every s; or for s > 2 a share of N on average (LengthPicks), and divided by
//             that
//   MIS       credit:  r is one constant, 1 <= r <= M
//             aware:   r of the records, then withEyeShare
//   s = 1     from the pool, or from next event; t = 1 is never resampled
#include "libcore/methods/importance_records.h"
#include "libcore/methods/length_pmfs.h"
#include "libcore/methods/methods.h"

namespace lacuna {

namespace {

struct Options {
    ImportanceRecords::Options records;
    double credit, eyeShare;
    bool nextEvent, everyLength;
    Picks picks;  ///< N
};

/// n r of a connection; frozen for an iteration.
class RecordDensity final : public ConnectionDensity {
  public:
    RecordDensity(const Options& options, const LengthPicks& picks,
                  const ImportanceRecords& records)
        : options_(options), picks_(picks), records_(records) {}

    std::optional<Constants> constants() const override {
        if (options_.records.aware || !options_.everyLength) return std::nullopt;
        return Constants{options_.nextEvent ? 1.0 : options_.credit, options_.credit};
    }
    bool tagsVertices() const override { return options_.records.aware; }
    std::uint32_t tagOf(const PathVertex& vertex) const override {
        return records_.nearest(vertex);
    }

    double effectiveSamples(const Connection& c) const override {
        if (options_.nextEvent && c.light.count == 1) return 1.0;
        const double chance = picks_.chance(c.light.count, c.order);
        if (!options_.records.aware) return chance * options_.credit;
        const double r = records_.samplesOf(c, records_.serving(*c.eye.vertex),
                                            picks_.repeats(c.light.count, c.order));
        return chance * withEyeShare(r, c.order, options_.eyeShare);
    }

  private:
    const Options& options_;
    const LengthPicks& picks_;
    const ImportanceRecords& records_;
};

class ImportanceCaching final : public Method {
  public:
    explicit ImportanceCaching(const Options& options)
        : options_(options),
          picks_(options.everyLength, options.picks),
          records_(options.records),
          density_(options_, picks_, records_) {}

    int warmupIterations() const override { return ImportanceRecords::kWarmupIterations; }
    PoolRequest pool() const override { return {options_.records.subpaths}; }
    bool learns() const override { return true; }
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }

    void prepare(const LightPool& pool, IterationContext& context) override {
        vertices_.assign(pool, !options_.nextEvent);
        records_.prepare(vertices_, context);
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (options_.nextEvent) proposeFreshLight(context, rng, sink);
        const std::uint32_t serving = records_.serving(context.vertex);
        const auto m = double(options_.records.subpaths);
        picks_.forEachPick(vertices_, context.order(), rng, [&](int s, double u, double n) {
            const ImportanceRecords::Pick pick = records_.pick(serving, s, u, rng);
            sink.add({vertices_.prefix(pick.place), 1.0 / (m * n * pick.probability), pick.label});
        });
    }

    void observe(const LightPool&, IterationContext& context) override {
        picks_.learn(vertices_);
        records_.observe(context);
    }

  private:
    Options options_;
    LengthPicks picks_;
    ImportanceRecords records_;
    RecordDensity density_;
    VerticesByLength vertices_;
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
        o.records.subpaths = s.integer("candidates");
        o.records.density = s.real("record_density");
        o.records.records = int(s.integer("records"));
        o.records.earlier = int(s.integer("q_records"));
        o.records.aware = s.integer("weights") == 1;
        o.credit = s.real("credit") > 0.0 ? s.real("credit") : double(o.records.subpaths);
        o.eyeShare = s.real("eye_share");
        o.nextEvent = s.on("next_event");
        o.everyLength = s.integer("lengths") == 0;
        o.picks = picksOf(s);
        return std::make_unique<ImportanceCaching>(o);
    };
    return row;
}

}  // namespace lacuna

// Importance caching [Georgiev12], adapted to bidirectional path tracing as in the comparison of
// [Noel15 5]. Light vertices are resampled at importance records on surfaces
// (importance_records.h). (theory.md, "icbpt")
//
//   pool      M = 1024 light subpaths, new in every iteration; L_s: their vertices y_{s-1}
//   records   vertices of record_density x pixels eye subpaths; `records` = 3 of them serve an eye
//             vertex
//   pick      N vertices y per s (the paper: one); contribution h(y) / (M N Pbar(y))
//   lengths   N picks for every s; or for s > 2 a share of N on average (LengthPicks), which then
//             stands in the place of N
//   MIS       credit:  r is one constant, M [Noel15, the authors' code]
//             aware:   r of the records, then withEyeShare
//   s = 1     from the pool, or from next event; t = 1 is never resampled
#include "libcore/methods/registry.h"
#include "libcore/resampling/importance_records.h"
#include "libcore/resampling/length_pmfs.h"

namespace lacuna {

namespace {

struct Options {
    ImportanceRecords::Options records;
    PickOptions picks = {.connections = 1, .first = 8};
    Believed weights = Believed::Aware;
    Lengths lengths = Lengths::Share;
    double eyeShare = 0.25;
    bool nextEvent = false;
    Lamps lamps = Lamps::Seen;

    bool aware() const { return weights == Believed::Aware; }
    double credit() const { return double(records.subpaths); }
};

/// n r of a connection; frozen for an iteration.
class RecordDensity final : public ConnectionDensity {
  public:
    RecordDensity(const Options& options, const LengthPicks& picks,
                  const ImportanceRecords& records)
        : options_(options), picks_(picks), records_(records) {}

    std::optional<Constants> constants() const override {
        if (options_.aware() || options_.lengths != Lengths::Every) return std::nullopt;
        return Constants{options_.nextEvent ? 1.0 : options_.credit(), options_.credit()};
    }
    Lamps lamps() const override { return lampsOf(options_.nextEvent, options_.lamps); }
    bool keepsLabels() const override { return options_.aware(); }
    void labelWalk(std::span<PathVertex> walk) const override { records_.labelAsEye(walk); }

    double effectiveSamples(const Connection& c) const override {
        if (options_.nextEvent && c.light.count == 1) return 1.0;
        const double chance = picks_.chance(c.light.count, c.order);
        if (!options_.aware()) return chance * options_.credit();
        const double r = records_.samplesOf(c, records_.serving(*c.eye.vertex, c.eye.label),
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
          picks_(options.lengths, options.picks.picks()),
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
        if (options_.nextEvent) proposeFreshLight(context, options_.lamps, rng, sink);
        const std::uint32_t serving = records_.serving(context.vertex, context.vertex.asEye);
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

MethodRow icbptRow() {
    const auto records = [](auto field) {
        return [field](auto& o) -> auto& {
            return o.records.*field;
        };
    };
    using Records = ImportanceRecords::Options;
    OptionTable<Options> table;
    table.integer("candidates", records(&Records::subpaths), 1, 1e6, "light subpaths",
                  "in the pool, M");
    table.include("", &Options::picks, pickOptions(Options{}.picks));
    table.real("record_density", records(&Records::density), 0, 16, "eye subpaths per pixel",
               "that leave importance records");
    table.integer("records", records(&Records::records), 1, 16, "records",
                  "that serve an eye vertex");
    addBelieved(table, &Options::weights);
    addLengths(table, &Options::lengths);
    addEyeShare(table, &Options::eyeShare);
    addNextEvent(table, &Options::nextEvent, &Options::lamps);
    return methodRow({.name = "icbpt",
                      .reference = "Georgiev12",
                      .summary = "resamples light vertices at importance records on surfaces",
                      .techniques = {.hits = true, .connects = true, .splats = true},
                      .proposalLabels = {"full", "unoccluded", "bounded", "uniform", "fallback"},
                      .paper = {"eye_share=0", "first_connections=0", "lamps=power",
                                "lengths=every", "weights=credit"}},
                     table, [](Options o) {
                         o.records.aware = o.aware();
                         return std::make_unique<ImportanceCaching>(o);
                     });
}

}  // namespace lacuna

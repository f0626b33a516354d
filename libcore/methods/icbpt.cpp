// Importance caching [Georgiev12] adapted to bidirectional path tracing as [Noel15 5] compares with
// it: light vertices resampled at importance records on surfaces.
//
//   pool      M = 1024 light subpaths, new in every iteration; L_s: their vertices y_{s-1}
//   records   vertices of record_density x pixels eye subpaths that add nothing to the image, new
//   in
//             every iteration (cache_points.h); an eye vertex is served by the `records` = 3
//             nearest
//   pmfs      over L_s, per record c and s:  F ∝ beta rho rho_c G V (full contribution),
//             U the same without V, B the same without V and rho_c and with G bounded by what it is
//             at four times the distance to the records around, C = 1 / |L_s|
//             combined by the maximum heuristic, one of them chosen evenly (length_pmfs.h)
//   pick      one y per s, from one of the records evenly; divided by the mixture's probability:
//             contribution h(y) / (M Pbar(y)),  Pbar = mean of P_c(y) over the records
//   MIS       r is one constant credit, 1 <= r <= M
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

struct Options {
    std::uint64_t subpaths;
    double density, credit;
    int records;
    bool nextEvent;
};

class ImportanceCaching final : public Method {
  public:
    explicit ImportanceCaching(const Options& options)
        : options_(options), density_(options.nextEvent ? 1.0 : options.credit, options.credit) {}

    PoolRequest pool() const override { return {options_.subpaths}; }
    const ConnectionDensity& freeze(std::uint32_t iteration) override {
        iteration_ = iteration;
        return density_;
    }

    void prepare(const LightPool& pool, IterationContext& context) override {
        {
            PhaseTimer timer(context.statistics, "importance records");
            records_ = CachePoints(context, options_.density, options_.records, iteration_);
        }
        PhaseTimer timer(context.statistics, "record distributions");
        vertices_.assign(pool, !options_.nextEvent);
        const auto lengths = std::size_t(vertices_.lengths()) + 1;
        pmfs_.assign(records_.size() * lengths, {});
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
                pmfs_[r * lengths + s] = CombinedPmf(rows, Choice::Even);
            }
        });
        for (const RayTally& t : tallies) context.statistics.add(t);
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (options_.nextEvent) proposeFreshLight(context, rng, sink);
        const auto around = records_.around(records_.serving(context.vertex));
        const auto lengths = std::size_t(vertices_.lengths()) + 1;
        const auto m = double(options_.subpaths);
        for (int s = 1; s < int(lengths); ++s) {
            const std::size_t count = vertices_.count(s);
            if (count == 0) continue;
            const double u = rng.uniformDouble();
            if (around.empty()) {
                const auto place = vertices_.begin(s) + std::size_t(u * double(count));
                sink.add({vertices_.prefix(place), double(count) / m, kRows});
                continue;
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
                      double(around.size()) / (m * sum), chosen.owner(index)});
        }
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
    ConstantDensity density_;
    CachePoints records_;          // of this iteration: the weights do not look at them
    std::uint32_t iteration_ = 0;  // addresses the records' random numbers
    VerticesByLength vertices_;
    std::vector<CombinedPmf> pmfs_;  // by record and s
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
                      {"record_density", Kind::Real, 0.001, 0, 16,
                       "eye subpaths that leave importance records, per pixel"},
                      {"records", Kind::Integer, 3, 1, 16, "records that serve an eye vertex"},
                      {"credit",
                       Kind::Real,
                       0,
                       0,
                       1e6,
                       "samples that a connection counts as; 0: all candidates",
                       {},
                       "candidates"},
                      nextEventParameter(false)};
    row.create = [](const Settings& s) {
        Options o;
        o.subpaths = s.integer("candidates");
        o.density = s.real("record_density");
        o.records = int(s.integer("records"));
        o.credit = s.real("credit") > 0.0 ? s.real("credit") : double(o.subpaths);
        o.nextEvent = s.on("next_event");
        return std::make_unique<ImportanceCaching>(o);
    };
    return row;
}

}  // namespace lacuna

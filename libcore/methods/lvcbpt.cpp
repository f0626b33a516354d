// Light vertex cache bidirectional path tracing [Davidovic14]. (theory.md, "lvcbpt")
//
//   pool      Y, all connectable vertices of M light subpaths, new in every iteration
//   pick      N per eye vertex, uniform over Y:  contribution |Y| / (M N) h(y), |Y| realised now
//   MIS       n r = N M / Vbar, Vbar the expected number of stored vertices of M subpaths, frozen:
//             from a warm-up that is thrown away, never from the pool that it weighs
//   s = 1     from the pool (y_0 is stored), or from next event: then y_0 is in neither Y nor Vbar
#include "libcore/methods/registry.h"
#include "libcore/resampling/merge_options.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

namespace {

struct Options {
    std::uint64_t subpaths = 100'000;  ///< M
    PickOptions picks = {.connections = 3};
    bool nextEvent = false;
    Lamps lamps = Lamps::Seen;
    MergeOptions merging = {};
};

class LightVertexCache final : public Method {
  public:
    explicit LightVertexCache(const Options& options)
        : subpaths_(options.subpaths),
          picks_(options.picks.picks()),
          nextEvent_(options.nextEvent),
          lamps_(options.lamps),
          merging_(options.merging.merging()),
          density_(picks_, nextEvent_, lamps_, 1.0) {}

    int warmupIterations() const override { return 1; }
    PoolRequest pool() const override { return {subpaths_}; }
    Merging merging() const override { return merging_; }

    const ConnectionDensity& freeze(std::uint32_t) override {
        density_ = PicksDensity(picks_, nextEvent_, lamps_, double(subpaths_) / expected_.value());
        return density_;
    }

    void prepare(const LightPool& pool, IterationContext&) override {
        pool_ = &pool;
        takePickable(pool, !nextEvent_, candidates_);
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (nextEvent_) proposeFreshLight(context, lamps_, rng, sink);
        const auto size = std::uint32_t(candidates_.size());
        if (size == 0) return;
        const int picks = picks_.at(context.order());
        const double weight = double(size) / (double(subpaths_) * picks);
        for (int i = 0; i < picks; ++i) {
            const std::uint32_t pick =
                rng.isEven() ? choose(rng, size, i, picks).index : rng.below(size);
            sink.add({pool_->prefix(candidates_[pick]), weight, 0});
        }
    }

    void observe(const LightPool&, IterationContext&) override {
        if (warm_) return;
        expected_.add(candidates_.size());
        warm_ = true;
    }

  private:
    std::uint64_t subpaths_;
    Picks picks_;
    bool nextEvent_;
    Lamps lamps_;
    Merging merging_;
    bool warm_ = false;
    ExpectedVertices expected_;
    PicksDensity density_;
    const LightPool* pool_ = nullptr;
    std::vector<LightPool::Entry> candidates_;
};

}  // namespace

MethodRow lvcbptRow() {
    OptionTable<Options> table;
    table.integer("candidates", &Options::subpaths, 1, 1e8, "light subpaths", "in the pool, M");
    table.include("", &Options::picks, pickOptions(Options{}.picks));
    addNextEvent(table, &Options::nextEvent, &Options::lamps);
    table.include("", &Options::merging, mergeOptions());
    return methodRow(
        {.name = "lvcbpt",
         .reference = "Davidovic14",
         .summary =
             "light vertex cache: joins eye vertices with random vertices of many light subpaths",
         .techniques = {.hits = true, .connects = true, .splats = true}},
        table, [](const Options& o) { return std::make_unique<LightVertexCache>(o); });
}

}  // namespace lacuna

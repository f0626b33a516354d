// Light vertex cache bidirectional path tracing [Davidovic14], as methods.md 2 states it.
//
//   pool      Y, all connectable vertices of M light subpaths, new in every iteration
//   pick      N per eye vertex, uniform over Y:  contribution |Y| / (M N) h(y), |Y| realised now
//   MIS       n r = N M / Vbar, Vbar the expected number of stored vertices of M subpaths, frozen:
//             from a warm-up that is thrown away, never from the pool that it weighs
//   s = 1     from the pool (y_0 is stored), or from next event: then y_0 is in neither Y nor Vbar
#include "libcore/methods/methods.h"

namespace lacuna {

namespace {

class LightVertexCache final : public Method {
  public:
    LightVertexCache(std::uint64_t subpaths, const Picks& picks, bool nextEvent)
        : subpaths_(subpaths),
          picks_(picks),
          nextEvent_(nextEvent),
          density_(picks, nextEvent, 1.0) {}

    int warmupIterations() const override { return 1; }
    PoolRequest pool() const override { return {subpaths_}; }

    const ConnectionDensity& freeze(std::uint32_t) override {
        // Any positive Vbar is unbiased: one vertex stands in where the warm-up saw none.
        density_ =
            PicksDensity(picks_, nextEvent_, double(subpaths_) / std::max(expectedVertices_, 1.0));
        return density_;
    }

    void prepare(const LightPool& pool, IterationContext&) override {
        pool_ = &pool;
        candidates_.clear();
        for (const LightPool::Entry& e : pool.connectable()) {
            if (!nextEvent_ || e.count > 1) candidates_.push_back(e);
        }
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (nextEvent_) proposeFreshLight(context, rng, sink);
        const auto size = std::uint32_t(candidates_.size());
        if (size == 0) return;
        const int picks = picks_.at(context.order());
        const double weight = double(size) / (double(subpaths_) * picks);
        for (int i = 0; i < picks; ++i) {
            sink.add({pool_->prefix(candidates_[rng.below(size)]), weight, 0});
        }
    }

    void observe(const LightPool&, IterationContext&) override {
        if (warm_) return;
        expectedVertices_ = double(candidates_.size());
        warm_ = true;
    }

  private:
    std::uint64_t subpaths_;
    Picks picks_;
    bool nextEvent_;
    bool warm_ = false;
    double expectedVertices_ = 0.0;
    PicksDensity density_;
    const LightPool* pool_ = nullptr;
    std::vector<LightPool::Entry> candidates_;
};

}  // namespace

MethodRow lvcRow() {
    MethodRow row;
    row.name = "lvcbpt";
    row.reference = "Davidovic14";
    row.summary = "light vertex cache: eye vertices with random vertices of many light subpaths";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.parameters = {
        lightPathsParameter(),
        {"candidates", Parameter::Kind::Integer, 1e5, 1, 1e8, "light subpaths in the pool, M"},
        connectionsParameter(3),
        firstConnectionsParameter(0),
        nextEventParameter(false)};
    row.create = [](const Settings& s) {
        return std::make_unique<LightVertexCache>(s.integer("candidates"), picksOf(s),
                                                  s.on("next_event"));
    };
    return row;
}

}  // namespace lacuna

// Path tracing with next event estimation [Kajiya86], [Veach97 10.3]. (theory.md, "pt")
//
// Every eye vertex z_{t-1} proposes one fresh light point y_0 (s = 1); eye paths that run into a
// light count as well (s = 0). MIS sees n = 1 sample of both. With lamps=power a fresh y_0 has the density of the light
// table, which is also p(y_0), so r = 1. Otherwise r is the quotient of the two densities.
#include "libcore/methods/registry.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

namespace {

struct Options {
    Lamps lamps = Lamps::Seen;
};

class PathTracing final : public Method {
  public:
    explicit PathTracing(const Options& options) : density_(1.0, 0.0, options.lamps) {}
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        proposeFreshLight(context, density_.lamps(), rng, sink);
    }

  private:
    ConstantDensity density_;
};

}  // namespace

MethodRow ptRow() {
    OptionTable<Options> table;
    addLamps(table, &Options::lamps);
    return methodRow(
        {.name = "pt",
         .reference = "Veach97",
         .summary = "path tracing: next event estimation and hits, combined by MIS weights",
         .techniques = {.hits = true, .connects = true}},
        table, [](const Options& o) { return std::make_unique<PathTracing>(o); });
}

}  // namespace lacuna

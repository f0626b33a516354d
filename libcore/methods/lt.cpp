// Light tracing [Arvo86], [Dutre93]: all light subpaths are seen by the lens (t = 1), nothing else.
// (theory.md, "lt")
//
// Exact for every path whose last scatter before the lens is smooth; what the lens sees through
// mirrors or smooth glass stays black, because no splat can make such a path.
#include "libcore/methods/registry.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

namespace {

class LightTracing final : public Method {
  public:
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void select(const EyeContext&, Rng&, ProposalSink&) const override {}

  private:
    ConstantDensity density_{0.0, 0.0};
};

}  // namespace

MethodRow ltRow() {
    return methodRow(
        {.name = "lt",
         .reference = "Dutre93",
         .summary = "light tracing: splats light paths to the lens (what mirrors show stays black)",
         .techniques = {.splats = true}},
        OptionTable<NoOptions>(), [](NoOptions) { return std::make_unique<LightTracing>(); });
}

}  // namespace lacuna

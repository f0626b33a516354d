// Bidirectional path tracing [Veach97 10], [Lafortune93]. (theory.md, "bpt")
//
// Every pixel traces one light subpath of its own; every eye vertex is connected to each of its
// vertices (M = 1, all are proposed with weight 1, so r = 1). With next_event the own y_0 makes way
// for a fresh light point per eye vertex, without the correlation of all direct light along an eye
// path: r = 1 as well where lamps are picked by power, else the quotient of the densities.
#include "libcore/methods/registry.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

namespace {

struct Options {
    bool nextEvent = true;
    Lamps lamps = Lamps::Seen;
};

class Bidirectional final : public Method {
  public:
    explicit Bidirectional(const Options& options)
        : nextEvent_(options.nextEvent),
          density_(1.0, 1.0, lampsOf(options.nextEvent, options.lamps)) {}
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (nextEvent_) proposeFreshLight(context, density_.lamps(), rng, sink);
        for (std::size_t s = nextEvent_ ? 2 : 1; s <= context.ownLightPath.size(); ++s) {
            const Subpath prefix = context.ownLightPath.first(s);
            if (prefix.back().connectable()) sink.add({prefix, 1.0, 0});
        }
    }

  private:
    bool nextEvent_;
    ConstantDensity density_;
};

}  // namespace

MethodRow bptRow() {
    OptionTable<Options> table;
    addNextEvent(table, &Options::nextEvent, &Options::lamps);
    return methodRow(
        {.name = "bpt",
         .reference = "Veach97",
         .summary =
             "bidirectional path tracing: every eye vertex with the pixel's own light subpath",
         .techniques = {.hits = true, .connects = true, .splats = true, .ownLightPath = true}},
        table, [](const Options& o) { return std::make_unique<Bidirectional>(o); });
}

}  // namespace lacuna

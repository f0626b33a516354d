#include "libcore/resampling/picks.h"

namespace lacuna {

OptionTable<PickOptions> pickOptions(const PickOptions& defaults, bool deep) {
    OptionTable<PickOptions> table(defaults);
    table.integer("connections", &PickOptions::connections, 1, Picks::kMost, "picks",
                  "per eye vertex, N");
    table.integer("first_connections", &PickOptions::first, 0, Picks::kMost, "picks",
                  "at the first eye vertex, also behind glass and in mirrors; 0: as many as "
                  "`connections` (the paper)");
    if (deep) {
        table.integer(
            "deep_connections", &PickOptions::deep, 0, Picks::kMost, "picks",
            "per eye vertex after the first two; 0: as many as `connections` (the paper)");
    }
    return table;
}

double withEyeShare(double samples, int order, double share) {
    if (order <= 1 || !(samples > 0.0)) return samples;
    return samples / (share * samples + (1.0 - share));
}

void takePickable(const LightPool& pool, bool direct, std::vector<LightPool::Entry>& entries) {
    entries.assign(pool.connectable().begin(), pool.connectable().end());
    if (!direct) std::erase_if(entries, [](const auto& e) { return e.count == 1; });
}

void proposeFreshLight(const EyeContext& context, Lamps lamps, Rng& rng, ProposalSink& sink) {
    PathVertex& y0 = sink.newVertex();
    LightSampler::Seen draw;
    if (lamps == Lamps::Seen) {
        draw = context.lights.sampleSeenLight(context.vertex, rng, y0);
    } else if (context.lights.sampleLight(rng, y0)) {
        draw.samples = 1.0;
    }
    if (draw.samples > 0.0) sink.add({Subpath(&y0, 1), draw.weight(), 0});
}

}  // namespace lacuna

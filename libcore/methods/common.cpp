#include "libcore/methods/methods.h"

namespace lacuna {

Parameter lightPathsParameter() {
    return {"light_paths",
            Parameter::Kind::Integer,
            0,
            0,
            1e9,
            "light subpaths traced for t = 1 in each iteration; 0: one per pixel of the full image",
            {},
            "width x height"};
}

Parameter nextEventParameter(bool defaultOn) {
    return {
        "next_event",
        Parameter::Kind::Switch,
        defaultOn ? 1.0 : 0.0,
        0,
        1,
        "on: s = 1 by one fresh light point per eye vertex; off: by the pool's own light points"};
}

Parameter presetParameter() {
    return {"preset",
            Parameter::Kind::Choice,
            0,
            0,
            1,
            "defaults that measured best, or the paper's; single parameters override it",
            {"measured", "paper"}};
}

Parameter connectionsParameter(int value) {
    return {"connections", Parameter::Kind::Integer, double(value), 1,
            Picks::kMost,  "picks per eye vertex, N"};
}

Parameter firstConnectionsParameter(int value) {
    return {"first_connections",
            Parameter::Kind::Integer,
            double(value),
            0,
            Picks::kMost,
            "picks at the first eye vertex, also behind glass and in mirrors; 0: as many as "
            "`connections` (the paper)"};
}

Picks picksOf(const Settings& s) {
    const int all = int(s.integer("connections")), first = int(s.integer("first_connections"));
    return {first > 0 ? first : all, all, all};
}

Parameter eyeShareParameter(double value) {
    return {
        "eye_share",
        Parameter::Kind::Real,
        value,
        0,
        1,
        "share of a connection's variance that is its eye subpath's, as the weights believe of all "
        "but the first eye vertex; 0: none (the paper)"};
}

double withEyeShare(double samples, int order, double share) {
    if (order <= 1 || !(samples > 0.0)) return samples;
    return samples / (share * samples + (1.0 - share));
}

void proposeFreshLight(const EyeContext& context, Rng& rng, ProposalSink& sink) {
    PathVertex& y0 = sink.newVertex();
    if (context.lights.sampleLight(rng, y0)) sink.add({Subpath(&y0, 1), 1.0, 0});
}

}  // namespace lacuna

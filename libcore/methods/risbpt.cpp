// Resampling-aware weights [Nabata20a]: light vertices resampled at cache points, under weights
// that know how much better a resampled vertex is than a random one. See resampling.h. Beside it
// the paper's counterexample [Nabata20a Fig. 3]: Q of the current pool, and so weights that depend
// on the light paths that they weigh.
#include "libcore/methods/methods.h"
#include "libcore/methods/resampling.h"

namespace lacuna {

namespace {

/// What both rows have.
std::vector<Parameter> awareParameters() {
    using Kind = Parameter::Kind;
    std::vector<Parameter> parameters = resamplingParameters(200, CacheTarget::Flow);
    parameters.push_back({"clamp", Kind::Real, 1e-3, 0, 1, "lower limit of p/q in the weights"});
    parameters.push_back(eyeShareParameter(0.1));
    return parameters;
}

ResamplingOptions awareOptions(const Settings& s) {
    ResamplingOptions o = resamplingOptions(s);
    o.clamp = s.real("clamp");
    o.eyeShare = s.real("eye_share");
    o.aware = true;
    return o;
}

}  // namespace

MethodRow resamplingAwareRow() {
    using Kind = Parameter::Kind;
    MethodRow row;
    row.name = "risbpt";
    row.reference = "Nabata20a";
    row.summary = "light vertices resampled at cache points, weights aware of the resampling";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.parameters = awareParameters();
    row.parameters.push_back({"q_points", Kind::Integer, 3, 1, 16,
                              "cache points of the last iteration whose Q are averaged, N_q"});
    row.parameters.push_back({"q_iterations", Kind::Integer, 16, 1, 256,
                              "earlier iterations whose Q are averaged; the paper: 1"});
    row.parameters.push_back({"weights",
                              Kind::Choice,
                              0,
                              0,
                              1,
                              "density that the weights see: resampling-aware, or r = 1",
                              {"ris", "plain"}});
    row.paper = {
        {"first_connections", 0}, {"eye_share", 0}, {"next_event", 0}, {"q_iterations", 1}};
    row.create = [](const Settings& s) {
        ResamplingOptions o = awareOptions(s);
        o.qPoints = int(s.integer("q_points"));
        o.qSets = int(s.integer("q_iterations"));
        o.aware = s.integer("weights") == 0;
        return makeResampling(o);
    };
    return row;
}

MethodRow currentSetRow() {
    MethodRow row;
    row.name = "risbpt-current";
    row.reference = "Nabata20a";
    row.summary = "risbpt with Q of the light paths that it weighs, to show the bias (Fig. 3)";
    // Splats come before the pool is complete: they would have to see another Q, and the weights of
    // a path would no longer add up to one. Without them Q alone is to blame.
    row.techniques = {.hits = true, .connects = true};
    row.biased = true;
    row.parameters = awareParameters();
    std::erase_if(row.parameters, [](const Parameter& p) { return p.name == "light_paths"; });
    row.paper = {{"first_connections", 0}, {"eye_share", 0}, {"next_event", 0}};
    row.create = [](const Settings& s) {
        ResamplingOptions o = awareOptions(s);
        o.currentQ = true;
        return makeResampling(o);
    };
    return row;
}

}  // namespace lacuna

// Probabilistic connections [Popov15], as [Nabata20a] compares with it: light vertices resampled at
// cache points, under the weights of plain bidirectional path tracing (r = 1). See resampling.h.
#include "libcore/methods/methods.h"
#include "libcore/methods/resampling.h"

namespace lacuna {

MethodRow probabilisticConnectionsRow() {
    MethodRow row;
    row.name = "pcbpt";
    row.reference = "Popov15";
    row.summary = "probabilistic connections: light vertices resampled at nearby cache points";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.parameters = resamplingParameters(100, CacheTarget::Flow);
    row.paper = {{"first_connections", 0}, {"next_event", 0}, {"target", 1}};
    row.create = [](const Settings& s) { return makeResampling(resamplingOptions(s)); };
    return row;
}

}  // namespace lacuna

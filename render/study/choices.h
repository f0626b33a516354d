// The choices of auto in a study's runs, and their regret against the other methods.
#pragma once

#include "render/study/tables.h"

namespace lacuna {

/// One row for each scene, measure and method auto; no rows if no method is auto.
///
/// Regret is auto's time over that of the best other method, including setup and pilot. The times
/// are those to the error that the worse of the two has at the end of the shortest run. Below one,
/// auto is faster.
Table choiceTable(const Results& results);

}  // namespace lacuna

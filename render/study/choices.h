// What auto chose in a study's runs, and what its choice cost beside the other rows.
#pragma once

#include "render/study/tables.h"

namespace lacuna {

/// A row for each scene, measure and method that chose for itself; none where no method did.
///
/// Regret is auto's time over that of the best other row, setup and pilot counted: the time to the
/// error that the worse of the two has where the shortest run ends. Below one auto is faster.
Table choiceTable(const Results& results);

}  // namespace lacuna

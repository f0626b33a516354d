// What shells complete behind lacuna-render's options: the registry's names, not a list of their own.
#pragma once

#include "libcore/tool/help_forms.h"

namespace lacuna {

/// Methods, their parameters, effects, samplers and measures.
ValueWords renderWords();

}  // namespace lacuna

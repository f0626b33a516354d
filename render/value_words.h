// Words with which shells complete the values of lacuna-render's options, taken from the registry.
#pragma once

#include "libcore/tool/help_forms.h"

namespace lacuna {

/// Methods, their parameters, effects, samplers and measures.
ValueWords renderWords();

}  // namespace lacuna

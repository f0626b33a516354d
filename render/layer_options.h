// --layer NAME=EXPRESSION, from text to what is rendered.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/path_layers.h"

namespace lacuna {

/// In the order of the command line. Throws UsageError for what is no NAME=EXPRESSION, for names that
/// the picture has for something else or that are there twice, and for what is no expression.
std::vector<LayerExpression> parseLayerExpressions(std::span<const std::string> texts);

}  // namespace lacuna

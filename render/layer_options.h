// --layer NAME=EXPRESSION and --cryptomatte, from text to what is rendered.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/path_layers.h"

namespace lacuna {

/// In the order of the command line. Throws UsageError for what is no NAME=EXPRESSION, for names that
/// the picture has for something else or that are there twice, and for what is no expression.
std::vector<LayerExpression> parseLayerExpressions(std::span<const std::string> texts);

/// What there are ids of.
struct MatteTypes {
    bool objects = false, materials = false;
    bool any() const { return objects || materials; }
};
/// "object,material" or one of them. Throws UsageError.
MatteTypes parseMatteTypes(const std::string& text);

}  // namespace lacuna

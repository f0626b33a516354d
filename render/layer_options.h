// Parses --layer NAME=EXPRESSION and --cryptomatte.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/path_layers.h"

namespace lacuna {

/// The layers in the order of the command line. Throws UsageError for a text that is not NAME=EXPRESSION, for a name
/// that is reserved or occurs twice, and for an invalid expression.
std::vector<LayerExpression> parseLayerExpressions(std::span<const std::string> texts);

/// The types of Cryptomattes to render.
struct MatteTypes {
    bool objects = false, materials = false;
    bool any() const { return objects || materials; }
};
/// Parses "object,material" or one of them. Throws UsageError.
MatteTypes parseMatteTypes(const std::string& text);

}  // namespace lacuna

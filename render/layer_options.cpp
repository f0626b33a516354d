#include "render/layer_options.h"

#include <algorithm>
#include <array>

#include "libcore/base/error.h"
#include "libcore/base/text_list.h"

namespace lacuna {
namespace {

/// Names of channels and layers that pictures and parts use themselves.
constexpr std::array kTaken = {"A",
                               "B",
                               "G",
                               "R",
                               "Y",
                               "Z",
                               "albedo",
                               "covariance",
                               "emission",
                               "light",
                               "lightSubspace",
                               "node",
                               "normal",
                               "part",
                               "position",
                               "product",
                               "rgba",
                               "share",
                               "square",
                               "subspace",
                               "sum",
                               "unweighted",
                               "variance",
                               "walks",
                               "weighted"};
constexpr const char* kTakenStart = "Crypto";

bool isPlain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
}

void checkName(const std::string& name) {
    constexpr std::size_t kLongest = 100;
    if (name.empty() || name.size() > kLongest || !std::ranges::all_of(name, isPlain)) {
        throw UsageError("--layer: expected a name of 1 to " + std::to_string(kLongest) +
                         " letters, digits, _ and -, found '" + name + "'");
    }
    if (name.starts_with(kTakenStart) || std::ranges::find(kTaken, name) != kTaken.end()) {
        throw UsageError("--layer: expected a name that pictures do not use themselves (" +
                         joined(kTaken, ", ") + ", Crypto..), found '" + name + "'");
    }
}

LayerExpression parse(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
        throw UsageError("--layer: expected NAME=EXPRESSION, found '" + text + "'");
    }
    LayerExpression layer{text.substr(0, equals), text.substr(equals + 1), "--layer " + text, {}};
    checkName(layer.name);
    layer.parsed = parseExpression(layer.text, layer.title);
    return layer;
}

}  // namespace

std::vector<LayerExpression> parseLayerExpressions(std::span<const std::string> texts) {
    std::vector<LayerExpression> layers;
    for (const std::string& text : texts) {
        LayerExpression layer = parse(text);
        if (std::ranges::find(layers, layer.name, &LayerExpression::name) != layers.end()) {
            throw UsageError("--layer: expected names that differ, found '" + layer.name +
                             "' twice");
        }
        layers.push_back(std::move(layer));
    }
    return layers;
}

MatteTypes parseMatteTypes(const std::string& text) {
    MatteTypes types;
    for (const std::string_view part : splitAtCommas(text)) {
        if (part == "object") {
            types.objects = true;
        } else if (part == "material") {
            types.materials = true;
        } else {
            throw UsageError(
                "--cryptomatte: expected object, material or object,material, found '" + text +
                "'");
        }
    }
    return types;
}

}  // namespace lacuna

// Selection of the picture's layers by name.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace lacuna {

/// Splits "variance,albedo" into two names. Throws UsageError, which names `option`, for an empty
/// name.
std::vector<std::string> parseLayers(const std::string& option, const std::string& text);

/// The channels of the picture, R G B, followed by those of `layers`. `there`: names of all
/// existing channels; a layer's channels keep this order. Throws UsageError, which names `option`
/// and the existing layers, for an unknown layer.
std::vector<std::string> channelsOfLayers(const std::string& option,
                                          std::span<const std::string> layers,
                                          std::span<const std::string> there);

}  // namespace lacuna

// Layers of the picture by the names that users have for them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace lacuna {

/// "variance,albedo" as two names. Throws UsageError that names `option` for an empty one.
std::vector<std::string> parseLayers(const std::string& option, const std::string& text);

/// The channels of the picture, R G B, and of the `layers`, in that order. `there`: names of all
/// channels, the layers' parts in the order in which they are to come. Throws UsageError that names
/// `option` and what there is for a layer that is not there.
std::vector<std::string> channelsOfLayers(const std::string& option,
                                          std::span<const std::string> layers,
                                          std::span<const std::string> there);

}  // namespace lacuna

#include "render/live/layer_names.h"

#include <algorithm>

#include "libcore/base/error.h"
#include "libcore/base/text_list.h"
#include "libcore/bidir/technique_group.h"

namespace lacuna {
namespace {

/// The layer of a channel: "albedo" for "albedo.R". A single channel (Z, share.t02) is a layer of
/// its own.
std::string layerOf(const std::string& channel) {
    const std::size_t dot = channel.rfind('.');
    const bool part = dot != channel.npos && dot + 2 == channel.size();
    return part ? channel.substr(0, dot) : channel;
}

/// The pattern of a layer's name: "weighted.sSStTT" for "weighted.s02t03", "weighted.mIItTT" for "weighted.m02t03",
/// "variance.GROUP" for "variance.hits1".
std::string forMany(const std::string& layer) {
    const std::size_t dot = layer.rfind('.');
    if (dot == layer.npos) return layer;
    const std::string_view name = std::string_view(layer).substr(dot + 1);
    if (name.size() == 6 && name[3] == 't') {
        if (name[0] == 's') return layer.substr(0, dot) + ".sSStTT";
        if (name[0] == 'm') return layer.substr(0, dot) + ".mIItTT";
    }
    for (std::size_t i = 0; i < TechniqueGroup::kCount; ++i) {
        if (name == TechniqueGroup::at(i).name()) return layer.substr(0, dot) + ".GROUP";
    }
    return layer;
}

/// A list of all layers; techniques and their groups appear as patterns.
std::string listOf(std::span<const std::string> there) {
    std::vector<std::string> names;
    for (const std::string& channel : there) {
        const std::string name = forMany(layerOf(channel));
        const bool picture = name == "R" || name == "G" || name == "B";
        if (!picture && std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    return joined(names, ", ");
}

}  // namespace

std::vector<std::string> parseLayers(const std::string& option, const std::string& text) {
    std::vector<std::string> names;
    for (const std::string_view name : splitAtCommas(text)) {
        names.emplace_back(name);
        if (name.empty()) {
            throw UsageError(option +
                             ": expected names of layers such as variance,albedo, found '" + text +
                             "'");
        }
    }
    return names;
}

std::vector<std::string> channelsOfLayers(const std::string& option,
                                          std::span<const std::string> layers,
                                          std::span<const std::string> there) {
    std::vector<std::string> channels{"R", "G", "B"};
    for (const std::string& layer : layers) {
        bool found = false;
        for (const std::string& channel : there) {
            if (layerOf(channel) != layer) continue;
            found = true;
            if (std::ranges::find(channels, channel) == channels.end()) channels.push_back(channel);
        }
        if (!found) {
            throw UsageError(option + ": expected a layer of this picture (" + listOf(there) +
                             "), found '" + layer + "'");
        }
    }
    return channels;
}

}  // namespace lacuna

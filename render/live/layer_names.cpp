#include "render/live/layer_names.h"

#include <algorithm>

#include "libcore/base/error.h"

namespace lacuna {
namespace {

/// "albedo" of "albedo.R"; a channel that stands alone (Z, share.t02) is a layer of its own.
std::string layerOf(const std::string& channel) {
    const std::size_t dot = channel.rfind('.');
    const bool part = dot != channel.npos && dot + 2 == channel.size();
    return part ? channel.substr(0, dot) : channel;
}

/// All of them, techniques as two of them.
std::string listOf(std::span<const std::string> there) {
    std::vector<std::string> names;
    for (const std::string& channel : there) {
        std::string name = layerOf(channel);
        if (name.starts_with("weighted.s")) name = "weighted.sSStTT";
        if (name.starts_with("unweighted.s")) name = "unweighted.sSStTT";
        const bool picture = name == "R" || name == "G" || name == "B";
        if (!picture && std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

}  // namespace

std::vector<std::string> parseLayers(const std::string& option, const std::string& text) {
    std::vector<std::string> names;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        names.push_back(text.substr(begin, end - begin));
        begin = end + 1;
        if (names.back().empty()) {
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

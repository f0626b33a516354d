#include "libcore/scene/light_groups.h"

#include <unordered_map>

namespace lacuna {

LightGroups lightGroups(std::span<const NamedLights> lights) {
    LightGroups result;
    std::unordered_map<std::string, std::uint32_t> indices;
    for (const NamedLights& some : lights) {
        const auto [entry, isNew] =
            indices.try_emplace(some.group, std::uint32_t(result.names.size()));
        if (isNew) result.names.push_back(some.group.empty() ? "unnamed" : some.group);
        result.group.insert(result.group.end(), some.count, entry->second);
    }
    return result;
}

}  // namespace lacuna

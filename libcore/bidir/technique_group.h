// Groups of techniques by what they do and where the eye subpath ends, for tables of noise and of time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace lacuna {

enum class TechniqueKind : std::uint8_t {
    Splats,       ///< t = 1
    Hits,         ///< s = 0
    Direct,       ///< s = 1, t >= 2: next event, or a pick of a light's own point
    Connections,  ///< s >= 2, t >= 2
    Merges,       ///< with photons
    Chains,       ///< of mirrors and smooth glass, to lights that no ray can hit
    Refractions,  ///< next event through smooth glass
};

/// A kind and, except for splats, an order (Connection::order). This is the order of the eye subpath's last vertex
/// before the connection or before the light that was hit, of the merged vertex, or of the vertex at a chain's end.
/// Order kOrders stands for all higher ones as well.
struct TechniqueGroup {
    static constexpr int kOrders = 3;
    static constexpr std::size_t kCount = 1 + 6 * std::size_t(kOrders);

    TechniqueKind kind = TechniqueKind::Splats;
    int order = 1;

    static TechniqueGroup of(int s, int t, int order) {
        if (t == 1) return {TechniqueKind::Splats, 1};
        const TechniqueKind kind = s == 0   ? TechniqueKind::Hits
                                   : s == 1 ? TechniqueKind::Direct
                                            : TechniqueKind::Connections;
        return {kind, std::min(order, kOrders)};
    }
    static TechniqueGroup ofMerge(int order) {
        return {TechniqueKind::Merges, std::min(order, kOrders)};
    }
    static TechniqueGroup ofChain(int order) {
        return {TechniqueKind::Chains, std::min(order, kOrders)};
    }
    static TechniqueGroup ofRefraction(int order) {
        return {TechniqueKind::Refractions, std::min(order, kOrders)};
    }
    /// The group with this index. Splats are the first.
    static TechniqueGroup at(std::size_t index) {
        if (index == 0) return {};
        const std::size_t kind = (index - 1) / kOrders;
        return {TechniqueKind(kind + 1), int((index - 1) % kOrders) + 1};
    }
    std::size_t index() const {
        if (kind == TechniqueKind::Splats) return 0;
        return (std::size_t(kind) - 1) * kOrders + std::size_t(order);
    }
    const char* kindName() const {
        constexpr const char* kNames[] = {"splats", "hits",   "direct",     "connections",
                                          "merges", "chains", "refractions"};
        return kNames[std::size_t(kind)];
    }
    /// The name in layers: "splats", "direct2".
    std::string name() const {
        return kind == TechniqueKind::Splats ? kindName() : kindName() + std::to_string(order);
    }
};

}  // namespace lacuna

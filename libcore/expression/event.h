// Events at the vertices of a path, in terms of light path expressions: the letters of their
// alphabet, and patterns of letters.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

/// A path begins at the camera, is reflected or transmitted any number of times, and ends on a light:
/// a lamp without a surface, a mesh that emits, or the environment.
enum class EventType : std::uint8_t { Camera, Reflection, Transmission, Lamp, Mesh, Environment };
/// How light is scattered at a vertex. Cameras and lights scatter nothing.
enum class Scattering : std::uint8_t { None, Diffuse, Glossy, Singular };

/// The event at one vertex.
struct VertexEvent {
    EventType type = EventType::Camera;
    Scattering scattering = Scattering::None;
    std::vector<std::string> names = {};  ///< the names of the object or the light

    bool operator==(const VertexEvent&) const = default;
};

/// A set of values of an enumeration, one bit per value.
using Bits = unsigned;
inline constexpr Bits kEveryBit = ~0u;
template <class Enum>
constexpr Bits bitOf(Enum value) {
    return 1u << unsigned(value);
}

/// `.`, `'a'`, `['a''b']` or `[^'a''b']`.
struct NamePattern {
    bool negated = true;
    std::vector<std::string> any = {};

    bool matches(const std::vector<std::string>& names) const {
        const bool found = std::ranges::any_of(names, [&](const std::string& name) {
            return std::ranges::find(any, name) != any.end();
        });
        return found != negated;
    }
};

/// `<type scattering name>`.
struct EventPattern {
    Bits types = kEveryBit;        ///< of EventType
    Bits scatterings = kEveryBit;  ///< of Scattering
    NamePattern names;

    bool matches(const VertexEvent& event) const {
        return (types & bitOf(event.type)) != 0 && (scatterings & bitOf(event.scattering)) != 0 &&
               names.matches(event.names);
    }
};

/// One pattern, `[..]` or `[^..]`.
struct EventSet {
    bool negated = false;
    std::vector<EventPattern> any = {};

    bool matches(const VertexEvent& event) const {
        const bool found = std::ranges::any_of(
            any, [&](const EventPattern& pattern) { return pattern.matches(event); });
        return found != negated;
    }
};

}  // namespace lacuna

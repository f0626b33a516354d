// The kinds of lobes of materials, with the names that --effects prints, so that users can leave
// some out.
#pragma once

#include <cstdint>

namespace lacuna {

enum class LobeKind : std::uint8_t {
    Diffuse,
    Glossy,           ///< rough reflection by metal, coat or clearcoat
    Mirror,           ///< smooth reflection by metal, coat or clearcoat
    RoughRefraction,  ///< of solid glass, including its reflection; likewise the next three
    SmoothRefraction,
    RoughThinTransmission,
    SmoothThinTransmission,
    DiffuseTransmission,
    Sheen
};

class LobeSet {
  public:
    void add(LobeKind kind) { bits_ = std::uint16_t(bits_ | bit(kind)); }
    bool has(LobeKind kind) const { return (bits_ & bit(kind)) != 0; }

  private:
    static unsigned bit(LobeKind kind) { return 1u << unsigned(kind); }

    std::uint16_t bits_ = 0;
};

}  // namespace lacuna

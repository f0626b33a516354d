// The kinds of lobes that materials are made of, by the names that --effects prints, so that some
// can be left out.
#pragma once

#include <cstdint>

namespace lacuna {

enum class LobeKind : std::uint8_t {
    Diffuse,
    Glossy,           ///< rough reflection by metal, coat or clearcoat
    Mirror,           ///< the same, perfectly smooth
    RoughRefraction,  ///< of solid glass, with what the glass reflects; so are the next three
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

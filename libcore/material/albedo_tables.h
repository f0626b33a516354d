// E(mu, alpha): the directional albedo of a rough dielectric layer (GGX x exact Fresnel), and its
// cosine-weighted mean E_avg. The diffuse base below gets the light that the layer does not
// reflect:
//     f_diffuse = rho / pi (1 - s E(mu_i)) (1 - s E(mu_o)) / (1 - s E_avg),   s the specular factor
// This is reciprocal, and its albedo is rho (1 - s E(mu_i)) if E_avg is the mean of the same E.
// Therefore E is bilinear between nodes, and E_avg is the exact integral of that bilinear function.
// The albedo of the layer and a white base together differs from 1 only by the interpolation error
// of E (kTableError).
//
// On both axes, index and fraction come from the bits of a float: nodes are equidistant within each
// octave, and a look-up needs no logarithm or root.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace lacuna {

/// Bound of the error of the table of E for ior in [1.01, 3], all angles up to the horizon and
/// alpha in [1e-4, 1]; tests measure it.
inline constexpr float kTableError = 1.5e-3f;

/// The table of one index of refraction.
class AlbedoTable {
  public:
    /// Position of alpha between two nodes, quantised so that it fits into every Bsdf. E and E_avg
    /// must be read with the same position.
    struct AlphaPosition {
        std::uint8_t index = 0;
        std::uint16_t fraction = 0;  ///< in units of 1 / 65536
    };

    explicit AlbedoTable(float ior);

    float ior() const { return ior_; }
    float smoothAverage() const { return smoothAverage_; }  ///< E_avg of the smooth layer
    static AlphaPosition positionOf(float alpha);
    float average(AlphaPosition alpha) const {
        return interpolate(averages_[alpha.index], averages_[alpha.index + 1u], weight(alpha));
    }
    /// E(mu), mu in [0, 1].
    float directional(AlphaPosition alpha, float mu) const {
        const std::uint32_t bits = std::bit_cast<std::uint32_t>(mu * (1.0f - kMuShift) + kMuShift) -
                                   std::bit_cast<std::uint32_t>(kMuShift);
        const float f = float(bits & ((1u << kMuBits) - 1u)) * (1.0f / float(1u << kMuBits));
        const float* a = values_.data() + alpha.index * std::uint32_t(kMuNodes) + (bits >> kMuBits);
        const float* b = a + kMuNodes;
        return interpolate(interpolate(a[0], a[1], f), interpolate(b[0], b[1], f), weight(alpha));
    }

  private:
    // mu: x = shift + mu (1 - shift) from 2^-13 to 1, 16 nodes per octave of x. The last node is
    // repeated, so that mu one rounding error above 1 is no special case.
    static constexpr float kMuShift = 0x1p-13f;
    static constexpr int kMuBits = 23 - 4;
    static constexpr int kMuNodes = 13 * 16 + 2;
    // alpha: 2^-14 to 1, 8 nodes per octave; the last is repeated.
    static constexpr float kAlphaMin = 0x1p-14f;
    static constexpr int kAlphaBits = 23 - 3;
    static constexpr int kAlphaNodes = 14 * 8 + 2;

    static float interpolate(float a, float b, float t) { return a + (b - a) * t; }
    static float weight(AlphaPosition alpha) { return float(alpha.fraction) * (1.0f / 65536.0f); }
    static float muNode(int i);
    static float alphaNode(int i);

    float ior_;
    float smoothAverage_;
    std::vector<float> values_;    // [alpha][mu]
    std::vector<float> averages_;  // [alpha]
};

/// The table of all clearcoats, whose index is Bsdf::kClearcoatIor. The first call makes it.
const AlbedoTable& clearcoatTable();

/// One table per distinct index of refraction. Immutable and read by all threads. Bsdfs point into
/// it.
class AlbedoTables {
  public:
    AlbedoTables() = default;
    /// `iors`: the indices of the scene's materials with a diffuse base under a dielectric layer;
    /// they may repeat. Each distinct index takes about 50 ms of one core; they run in parallel.
    explicit AlbedoTables(std::span<const float> iors);

    /// The table of exactly this index, or null.
    const AlbedoTable* find(float ior) const;
    /// The table of the smallest index that is not below `ior`, or else of the largest one. Its
    /// layer reflects at least as much, so that the base gets no more light than the layer leaves.
    /// Null only if there are no tables.
    const AlbedoTable* covering(float ior) const;

  private:
    std::vector<AlbedoTable> tables_;  // sorted by index
};

}  // namespace lacuna

// Counter-based random numbers. A stream is addressed, never advanced from a shared state. Any
// sample of any iteration can therefore be drawn again alone, and no result depends on the number
// of threads.
#pragma once

#include <Random123/philox.h>

#include <array>
#include <cstdint>

namespace lacuna {

/// The purpose of a stream. Streams of different kinds are independent.
enum class StreamKind : std::uint32_t {
    LightPath,   ///< index = light path
    EyePath,     ///< index = pixel (row * width + column)
    Connection,  ///< the selector's own numbers along an eye path, index = pixel
    Warmup,      ///< light paths of the warm-up iterations that are thrown away
    Features,    ///< albedo, normal and depth layers
    User,        ///< tests and tools
    CachePath,   ///< eye paths that leave cache points, index = path
    CacheDraw,   ///< draws at a cache point, index = cache point
    Chain,       ///< searches for specular chains along an eye path, index = pixel
    Mattes,      ///< coverage by objects and materials (Cryptomatte), index = pixel
    Refraction,  ///< next-event estimation through glass, along an eye path, index = pixel
    Sharing,     ///< a pixel's choices among the eye paths of other pixels, index = pixel
    KnownWay,    ///< next-event estimation along known ways, along an eye path, index = pixel
};

/// A point of a low-discrepancy sequence (owen.h). Its numbers are called even.
struct EvenPoint {
    std::uint64_t sequence = 0;
    std::uint32_t index = 0;
    std::uint32_t dimensions = 0;  ///< dimensions of the point; 0: there is no sequence
};

/// One stream of uniform numbers: Philox4x32-7 [Salmon et al. 2011], the fewest rounds that pass
/// BigCrush there, keyed by (seed, iteration), counted by (block, kind, index).
class Rng {
  public:
    Rng(std::uint64_t seed, std::uint32_t iteration, StreamKind kind, std::uint64_t index)
        : key_{{std::uint32_t(seed), iteration}},
          counter_{{0, std::uint32_t(kind) | std::uint32_t(index >> 32) << 8, std::uint32_t(index),
                    std::uint32_t(seed >> 32)}} {}

    std::uint32_t bits() {
        if (used_ == 4) {
            block_ = generate_(counter_, key_);
            ++counter_.v[0];
            used_ = 0;
        }
        return block_.v[used_++];
    }
    /// Uniform float in [0, 1): 24 bits, never 1.
    float uniform() { return floatOf(bits()); }
    /// Uniform double in [0, 1): 53 bits, for choices among very many or very unlikely outcomes.
    double uniformDouble() {
        const std::uint32_t high = bits(), low = bits();
        return doubleOf(high, low);
    }
    /// One double and two floats, each uniform in [0, 1).
    struct Draw {
        double pick;
        float u1, u2;
        bool even = false;  ///< the pair (u1, u2) is even, and pick by itself
    };
    /// The numbers that uniformDouble() and two uniform() would give in turn, at a lower cost.
    Draw draw() {
        if (used_ != 4) {
            const double pick = uniformDouble();
            const float u1 = uniform(), u2 = uniform();
            return {pick, u1, u2};
        }
        const Philox::ctr_type b = generate_(counter_, key_);
        ++counter_.v[0];
        return {doubleOf(b.v[0], b.v[1]), floatOf(b.v[2]), floatOf(b.v[3])};
    }
    /// Uniform integer in [0, n), n >= 1. Each probability is 1/n to within 2^-32.
    std::uint32_t below(std::uint32_t n) {
        return std::uint32_t((std::uint64_t(bits()) * n) >> 32);
    }

    /// Sets the point that the stream's even numbers come from. Beyond the point's dimensions, and
    /// without a point, they are the stream's next random numbers.
    void follow(const EvenPoint& point) { point_ = point; }
    /// The next even number will be that of `dimension`, whatever was drawn before.
    void toDimension(std::uint32_t dimension) { dimension_ = dimension; }
    struct Pair {
        float u1, u2;
    };
    /// Even numbers, each call from one dimension.
    float evenUniform() { return isEven() ? evenFloat() : uniform(); }
    Pair evenPair() {
        if (isEven()) return evenSquare();
        const float u1 = uniform(), u2 = uniform();
        return {u1, u2};
    }
    /// An even draw from two dimensions: `pick` from the first, (u1, u2) from the second.
    Draw evenDraw() { return isEven() ? evenDrawn() : draw(); }
    /// The i-th of n numbers that are drawn from one dimension and are even together.
    double evenPick(std::uint32_t i, std::uint32_t n) {
        return isEven() ? evenDouble(point_.index * n + i) : uniformDouble();
    }
    bool isEven() const { return dimension_ < point_.dimensions; }

  private:
    float evenFloat();
    Pair evenSquare();
    Draw evenDrawn();
    double evenDouble(std::uint32_t index) const;

    using Philox = r123::Philox4x32_R<7>;
    static float floatOf(std::uint32_t bits) { return float(bits >> 8) * 0x1p-24f; }
    static double doubleOf(std::uint64_t high, std::uint64_t low) {
        return double((high << 32 | low) >> 11) * 0x1p-53;
    }

    Philox generate_{};
    Philox::key_type key_;
    Philox::ctr_type counter_;
    Philox::ctr_type block_{};
    unsigned used_ = 4;
    std::uint32_t dimension_ = 0;
    EvenPoint point_;
};

/// Uniform float in [0, 1) that depends on the words alone: a random number where there is no
/// stream.
inline float hashToUniform(const std::array<std::uint32_t, 8>& words) {
    using Philox = r123::Philox4x32_R<7>;
    Philox::ctr_type block{{words[0], words[1], words[2], words[3]}};
    block = Philox{}(block, {{words[4], words[5]}});
    block = Philox{}(block, {{words[6], words[7]}});
    return float(block.v[0] >> 8) * 0x1p-24f;
}

}  // namespace lacuna

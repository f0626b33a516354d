// A low-discrepancy sequence in the unit square: the first two dimensions of Sobol's sequence
// [Sobol67; Joe08], a (0,2)-sequence in base 2, with Owen scrambling [Owen98] by hashes [Burley20].
//
// Take 2^m consecutive points whose indices begin at a multiple of 2^m. For every shape 2^-a x
// 2^-(m-a), each of the 2^m boxes of this shape holds one of them. Every single point is uniform.
// Sequences of different seeds are independent, so that pairs of dimensions can be padded (put side
// by side).
// (theory.md, "Even numbers")
#pragma once

#include <cstdint>

namespace lacuna {

constexpr std::uint32_t reverseBits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

/// Flips each bit or not, depending on the bits below it: Owen scrambling of a number whose bits
/// are reversed. Constants: [Vegdahl21].
constexpr std::uint32_t scrambleReversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= seed >> 16 | 1u;
    x ^= x * 0x05526c56u;
    return x ^ x * 0x53a22864u;
}

/// Sobol's second dimension with its bits reversed: Pascal's triangle mod 2 times the index. The
/// direction numbers of Joe and Kuo give the same.
constexpr std::uint32_t sobolSecondReversed(std::uint32_t index) {
    index ^= index >> 16;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xccccccccu) >> 2;
    return index ^ (index & 0xaaaaaaaau) >> 1;
}

/// A hash of 64 bits in which every bit depends on every bit of the key (SplitMix64).
constexpr std::uint64_t mixBits(std::uint64_t key) {
    key = (key ^ key >> 30) * 0xbf58476d1ce4e5b9u;
    key = (key ^ key >> 27) * 0x94d049bb133111ebu;
    return key ^ key >> 31;
}

/// Two fractions in [0, 1), each as 32 bits after the binary point.
struct OwenPair {
    std::uint32_t x, y;
};

/// Point `index` of the sequence of `seed`.
constexpr OwenPair owenPair(std::uint32_t index, std::uint64_t seed) {
    const std::uint64_t one = mixBits(seed + 0x9e3779b97f4a7c15u), other = mixBits(~seed);
    // The order of the points is scrambled as well; otherwise padded pairs would be correlated.
    const std::uint32_t order =
        reverseBits(scrambleReversed(reverseBits(index), std::uint32_t(one)));
    return {reverseBits(scrambleReversed(order, std::uint32_t(one >> 32))),
            reverseBits(scrambleReversed(sobolSecondReversed(order), std::uint32_t(other)))};
}

/// Element `index` of the one-dimensional sequence of `seed`.
constexpr std::uint32_t owenNumber(std::uint32_t index, std::uint64_t seed) {
    const std::uint64_t one = mixBits(seed + 0x9e3779b97f4a7c15u);
    const std::uint32_t order =
        reverseBits(scrambleReversed(reverseBits(index), std::uint32_t(one)));
    return reverseBits(scrambleReversed(order, std::uint32_t(one >> 32)));
}

}  // namespace lacuna

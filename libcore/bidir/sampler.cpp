// (theory.md, "Even numbers")
#include "libcore/bidir/sampler.h"

#include "libcore/base/owen.h"

namespace lacuna {

namespace {

/// Iterations of a group. Variances come from whole groups: a render of 64 iterations has eight.
/// Groups are farther apart than independent samples.
constexpr std::uint64_t kGroup = 8;

std::uint32_t dimensionsOf(StreamKind kind) {
    constexpr std::uint32_t kOfVertices = dimension::kVertices * dimension::kPerVertex;
    switch (kind) {
        case StreamKind::LightPath:
        case StreamKind::EyePath:
            return dimension::kStart + kOfVertices;
        case StreamKind::Connection:
            return kOfVertices;
        default:
            return 0;
    }
}

}  // namespace

Sampler::Sampler(Sampling sampling, std::uint64_t seed)
    : sampling_(sampling), seed_(seed), sequences_(mixBits(mixBits(seed))) {}

std::uint64_t Sampler::groupOf(Sampling sampling) {
    return sampling == Sampling::Sobol ? kGroup : 1;
}

Rng Sampler::stream(std::uint32_t iteration, StreamKind kind, std::uint64_t index) const {
    Rng rng(seed_, iteration, kind, index);
    const std::uint32_t dimensions = dimensionsOf(kind);
    if (sampling_ == Sampling::Independent || dimensions == 0) return rng;
    const std::uint64_t stream = std::uint64_t(kind) << 56 | index;
    rng.follow({mixBits(sequences_ ^ stream), iteration, dimensions});
    return rng;
}

}  // namespace lacuna

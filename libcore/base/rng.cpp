#include "libcore/base/rng.h"

#include "libcore/base/owen.h"

namespace lacuna {

namespace {

std::uint64_t seedOf(const EvenPoint& point, std::uint32_t dimension) {
    return point.sequence + 0xd1342543de82ef95u * (dimension + 1);
}

}  // namespace

float Rng::evenFloat() {
    return floatOf(owenNumber(point_.index, seedOf(point_, dimension_++)));
}

Rng::Pair Rng::evenSquare() {
    const OwenPair p = owenPair(point_.index, seedOf(point_, dimension_++));
    return {floatOf(p.x), floatOf(p.y)};
}

double Rng::evenDouble(std::uint32_t index) const {
    const std::uint64_t seed = seedOf(point_, dimension_);
    // The high 32 bits are even; the low bits are merely uniform.
    return doubleOf(owenNumber(index, seed), mixBits(seed ^ mixBits(index)) >> 32);
}

Rng::Draw Rng::evenDrawn() {
    const double pick = evenDouble(point_.index);
    ++dimension_;
    const Pair p = evenSquare();
    return {pick, p.u1, p.u2, true};
}

}  // namespace lacuna

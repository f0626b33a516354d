#include "libcore/bidir/absorption.h"

#include <cmath>

namespace lacuna {

Rgb transmittanceInside(std::span<const Rgb> absorption, const EdgeEnd& a, Vec3 direction,
                        const EdgeEnd& b) {
    Rgb sum;
    int inside = 0;
    const auto ask = [&](const EdgeEnd& v, Vec3 leaving) {
        if (v.material == kNone || !(dot(v.ng, leaving) < 0.0f)) return;
        const Rgb& sigma = absorption[v.material];
        if (isBlack(sigma)) return;
        sum += sigma;
        ++inside;
    };
    ask(a, direction);
    ask(b, -direction);
    if (inside == 0) return Rgb(1.0f);
    const double distance = length(Vec3d(b.position) - Vec3d(a.position)) / inside;
    const auto left = [&](float sigma) { return float(std::exp(-double(sigma) * distance)); };
    return {left(sum.r), left(sum.g), left(sum.b)};
}

}  // namespace lacuna

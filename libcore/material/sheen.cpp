#include "libcore/material/sheen.h"

#include <tbb/task_arena.h>

#include <array>
#include <cstddef>
#include <numbers>

#include "libcore/base/tbb_loop.h"

namespace lacuna {
namespace {

/// int D V |cos| over all directions above the surface, by the midpoint rule in the azimuth and in the root of the
/// cosine, which is dense at grazing angles.
double directionalAlbedo(double roughness, double mu) {
    constexpr int kAzimuths = 20, kSteps = 64;
    static const auto kCosineOfAzimuth = [] {
        std::array<double, kAzimuths> cosines{};
        for (int i = 0; i < kAzimuths; ++i) {
            cosines[std::size_t(i)] = std::cos(std::numbers::pi * (i + 0.5) / kAzimuths);
        }
        return cosines;
    }();
    const double alpha = sheen::alphaOf(roughness);
    const sheen::Shadowing<double> shadowing(alpha);
    const double seen = 1 + shadowing.lambda(mu), sine = std::sqrt(1 - mu * mu);
    double sum = 0;
    for (int j = 0; j < kSteps; ++j) {
        const double root = (j + 0.5) / kSteps, cosine = root * root;
        const double s = std::sqrt(1 - cosine * cosine), h = mu + cosine;
        double ring = 0;
        for (const double c : kCosineOfAzimuth) {
            const double across2 = sine * sine + s * s + 2 * sine * s * c;  // of the half vector
            ring += sheen::distribution(alpha, across2 / (across2 + h * h));
        }
        // 2 pi x mean over the azimuth x D / (4 mu (1 + ..)), d cosine = 2 root d root
        sum += ring * 2 * root / (seen + shadowing.lambda(cosine));
    }
    return sum * 2 * std::numbers::pi / (4 * mu * kAzimuths * kSteps);
}

}  // namespace

SheenTable::SheenTable() : values_(std::size_t(kRoughnesses) * kCosines) {
    tbbLoop(kRoughnesses * kCosines, [&](int i) {
        const double roughness = double(i / kCosines) / (kRoughnesses - 1);
        const double root = std::max(1e-3, double(i % kCosines) / (kCosines - 1));
        values_[std::size_t(i)] = float(directionalAlbedo(roughness, root * root));
    });
}

float SheenTable::directional(float roughness, float mu) const {
    const auto place = [](float x, int nodes, int& index) {
        const float scaled = std::clamp(x, 0.0f, 1.0f) * float(nodes - 1);
        index = std::min(int(scaled), nodes - 2);
        return scaled - float(index);
    };
    int row = 0, column = 0;
    const float r = place(roughness, kRoughnesses, row);
    const float c = place(std::sqrt(std::max(0.0f, mu)), kCosines, column);
    const float* a = values_.data() + std::ptrdiff_t(row) * kCosines + column;
    const float* b = a + kCosines;
    const float low = a[0] + (a[1] - a[0]) * c, high = b[0] + (b[1] - b[0]) * c;
    return low + (high - low) * r;
}

const SheenTable& sheenTable() {
    // Isolated: the thread that makes the table must not begin other work, which might need the
    // table.
    static const SheenTable table = tbb::this_task_arena::isolate([] { return SheenTable(); });
    return table;
}

}  // namespace lacuna

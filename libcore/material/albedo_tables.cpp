#include "libcore/material/albedo_tables.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "libcore/base/tbb_loop.h"
#include "libcore/material/bsdf.h"
#include "libcore/material/fresnel.h"
#include "libcore/material/microfacet.h"

namespace lacuna {
namespace {

constexpr int kRadial = 14;
constexpr int kAngular = 8;
constexpr std::size_t kPoints = std::size_t(kRadial) * kAngular;

/// Points of the unit disk and their weights, as separate arrays for vectorisation.
struct DiskRule {
    std::array<double, kPoints> x, y, sqrtOneMinusX2, weight;
};

/// Product rule for the mean over the unit disk of a function even in x. It uses midpoints in the
/// angle (spectral convergence for smooth periodic functions) and Gauss-Legendre in t, where r^2 =
/// 1 - (1 - t)^2. This is dense at the rim, which holds the tail of GGX.
DiskRule makeDiskRule() {
    DiskRule rule{};
    std::size_t out = 0;
    for (int i = 0; i < kRadial; ++i) {
        // Newton's method on the Legendre polynomial P_n from Tricomi's initial guess.
        double x = std::cos(std::numbers::pi * (i + 0.75) / (kRadial + 0.5));
        double derivative = 1;
        for (int step = 0; step < 20; ++step) {
            double p0 = 1, p1 = x;
            for (int k = 2; k <= kRadial; ++k) {
                const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
                p0 = p1;
                p1 = p2;
            }
            derivative = kRadial * (x * p1 - p0) / (x * x - 1);
            x -= p1 / derivative;
        }
        const double rest = 0.5 * (1 - x);  // 1 - t
        const double r = std::sqrt(1 - rest * rest);
        const double weightT = 1 / ((1 - x * x) * derivative * derivative);  // on [0, 1]
        for (int j = 0; j < kAngular; ++j, ++out) {
            const double phi = std::numbers::pi * (j + 0.5) / kAngular;
            rule.x[out] = r * std::sin(phi);
            rule.y[out] = r * std::cos(phi);
            rule.sqrtOneMinusX2[out] = std::sqrt(1 - rule.x[out] * rule.x[out]);
            rule.weight[out] = 2 * rest * weightT / kAngular;
        }
    }
    return rule;
}

/// E = mean over visible normals of F(i.h) G2 / G1(i), with the reflected direction above the
/// horizon. The normals are those of ggx::visibleNormal [Heitz18] for a view in the plane x = 0.
/// The code is written out without branches, which makes it three times as fast.
double directionalAlbedo(const DiskRule& rule, double mu, double alpha, double ior) {
    mu = std::max(mu, 1e-7);
    const double alpha2 = alpha * alpha;
    const double sine = std::sqrt(std::max(0.0, 1 - mu * mu));
    const double s = ggx::smithS(mu, alpha2);
    const double invLength = 1 / std::sqrt(alpha2 * sine * sine + mu * mu);
    const double vhY = alpha * sine * invLength, vhZ = mu * invLength;  // the stretched view
    const double blend = 0.5 * (1 + vhZ);
    const double k = (ior - 1) * (ior + 1);
    std::array<double, kPoints> terms;
    for (std::size_t i = 0; i < kPoints; ++i) {
        const double y = (1 - blend) * rule.sqrtOneMinusX2[i] + blend * rule.y[i];
        const double x2 = rule.x[i] * rule.x[i];
        const double z = std::sqrt(std::max(0.0, 1 - x2 - y * y));
        const double hX2 = alpha2 * x2;
        const double hY = alpha * (z * vhY - y * vhZ);
        const double hZ = std::max(1e-7, z * vhZ + y * vhY);
        const double inverse = 1 / std::sqrt(hX2 + hY * hY + hZ * hZ);
        const double vh = std::clamp((sine * hY + mu * hZ) * inverse, 0.0, 1.0);
        const double co = std::clamp(2 * vh * hZ * inverse - mu, 0.0, 1.0);
        const double so = std::sqrt(co * co + alpha2 * (1 - co * co));
        // fresnelDielectric for an index >= 1
        const double sum = std::sqrt(k + vh * vh) + vh + 1e-300;
        const double difference = k / sum;
        const double a = vh * sum - 1, b = vh * difference + 1, c = sum * b;
        const double fresnel = 0.5 * difference * difference * (a * a + b * b) / (c * c);
        // G2 / G1 = co (mu + s) / (s co + so mu)
        terms[i] = rule.weight[i] * fresnel * co * (mu + s) / (s * co + so * mu);
    }
    double total = 0;
    for (const double t : terms) {
        total += t;
    }
    return total;
}

}  // namespace

float AlbedoTable::muNode(int i) {
    const std::uint32_t bits =
        std::bit_cast<std::uint32_t>(kMuShift) + (std::uint32_t(i) << kMuBits);
    return std::min(1.0f, (std::bit_cast<float>(bits) - kMuShift) / (1.0f - kMuShift));
}

float AlbedoTable::alphaNode(int i) {
    const std::uint32_t bits =
        std::bit_cast<std::uint32_t>(kAlphaMin) + (std::uint32_t(i) << kAlphaBits);
    return std::min(1.0f, std::bit_cast<float>(bits));
}

AlbedoTable::AlphaPosition AlbedoTable::positionOf(float alpha) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(std::clamp(alpha, kAlphaMin, 1.0f)) -
                               std::bit_cast<std::uint32_t>(kAlphaMin);
    return {std::uint8_t(bits >> kAlphaBits),
            std::uint16_t((bits & ((1u << kAlphaBits) - 1u)) >> (kAlphaBits - 16))};
}

AlbedoTable::AlbedoTable(float ior)
    : ior_(ior),
      smoothAverage_(float(fresnelAverage(double(ior)))),
      values_(std::size_t(kAlphaNodes) * kMuNodes),
      averages_(std::size_t(kAlphaNodes)) {
    const DiskRule rule = makeDiskRule();
    tbbLoop(kAlphaNodes, [&](int a) {
        float* rowValues = values_.data() + std::ptrdiff_t(a) * kMuNodes;
        for (int m = 0; m < kMuNodes; ++m) {
            rowValues[m] = float(
                directionalAlbedo(rule, double(muNode(m)), double(alphaNode(a)), double(ior)));
        }
        // 2 int E mu dmu of the piecewise linear function, exactly: Simpson's rule, degree 2.
        double sum = 0;
        for (int m = 0; m + 1 < kMuNodes; ++m) {
            const double mu0 = double(muNode(m)), mu1 = double(muNode(m + 1));
            const double e0 = double(rowValues[m]), e1 = double(rowValues[m + 1]);
            sum += (mu1 - mu0) / 6 * (e0 * mu0 + (e0 + e1) * (mu0 + mu1) + e1 * mu1);
        }
        averages_[std::size_t(a)] = float(2 * sum);
    });
}

const AlbedoTable& clearcoatTable() {
    // Isolated: the thread that makes the table must not begin other work, which might need the
    // table.
    static const AlbedoTable table =
        tbb::this_task_arena::isolate([] { return AlbedoTable(Bsdf::kClearcoatIor); });
    return table;
}

AlbedoTables::AlbedoTables(std::span<const float> iors) {
    std::vector<float> distinct(iors.begin(), iors.end());
    std::sort(distinct.begin(), distinct.end());
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    tables_.reserve(distinct.size());
    for (const float ior : distinct) {
        tables_.emplace_back(ior);
    }
}

const AlbedoTable* AlbedoTables::find(float ior) const {
    for (const AlbedoTable& table : tables_) {
        if (table.ior() == ior) {
            return &table;
        }
    }
    return nullptr;
}

const AlbedoTable* AlbedoTables::covering(float ior) const {
    for (const AlbedoTable& table : tables_) {
        if (table.ior() >= ior) {
            return &table;
        }
    }
    return tables_.empty() ? nullptr : &tables_.back();
}

}  // namespace lacuna

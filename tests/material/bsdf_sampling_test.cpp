// Compares samples with densities and energies over the whole grid: chi-square of the sampled
// directions against the integrated density, empty draws against what the density lacks to 1,
// weights against quadrature. No case may gain energy.
//
// False alarms: kAlarm for each suite as a whole, whatever the number of cases. The seeds are fixed,
// so a suite that passes once always passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/material/half_vector_bins.h"
#include "tests/material/materials.h"
#include "tests/material/statistics.h"

namespace lacuna::test {
namespace {

constexpr double kAlarm = 1e-3;
constexpr double kQuadrature = 0.004;  // bound of the quadrature's error in any integral

struct Integrals {
    std::vector<double> mass;  // density per bin
    double density = 0;        // in all bins and delta events
    double energy = 0;         // likewise, of f |to.ng| without eta^2
    std::vector<double> deltaPmf;
};

/// The direction of a delta event about one of the normals.
struct DeltaEvent {
    ScatterEvent event;
    Vec3 to;
    double cosine;  ///< |to . n| of that normal, a factor of the density
};

/// All delta events of a case, computed in double from the definition.
std::vector<DeltaEvent> deltaEvents(const Case& c) {
    std::vector<DeltaEvent> out;
    const Vec3d v = Vec3d(c.from), ng = Vec3d(c.bsdf.ng()), ns = Vec3d(c.bsdf.ns());
    const Vec3d coat(c.parameters.clearcoatNormal);
    const bool ownCoat = length(coat) > 0;
    const bool straight = c.parameters.thin || c.parameters.ior == 1.0f;
    for (const auto& [normal, byNg] :
         {std::pair(ns, false), std::pair(ng, true), std::pair(coat, false)}) {
        const Vec3d n = normal * (c.front ? 1.0 : -1.0);
        const double cosine = dot(v, n);
        if (cosine <= 0) continue;
        const auto add = [&](ScatterEvent event, Vec3d to, double toCosine) {
            const Vec3d eye = c.side == Side::Eye ? v : to;
            const bool seen =
                byNg ? shareOfNg(eye, ng, ns) > 0 || (ownCoat && shareOfNg(eye, ng, coat) > 0)
                     : shareOfNg(eye, ng, normal) < 1;
            const bool known = std::any_of(out.begin(), out.end(), [&](const DeltaEvent& other) {
                return other.event == event && length(Vec3d(other.to) - to) < 1e-5;
            });
            if (seen && !known) out.push_back({event, Vec3(to), toCosine});
        };
        add(ScatterEvent::DeltaReflection, normalize(n * (2 * cosine) - v), cosine);
        const double eta = c.indexOn(!c.front) / c.indexOn(c.front);
        const double sine2 = (1 - cosine * cosine) / (eta * eta);
        if (straight || sine2 > 1) continue;
        const double through = std::sqrt(1 - sine2);
        add(ScatterEvent::DeltaTransmission,
            normalize(n * (cosine / eta - through) - v * (1 / eta)), through);
    }
    if (straight) {  // one event for all normals
        out.push_back({ScatterEvent::DeltaTransmission, -c.from, std::abs(dot(v, ng))});
    }
    return out;
}

Integrals integrate(const Case& c, const TwoNormalBins& bins,
                    const std::vector<DeltaEvent>& deltas) {
    Integrals out;
    out.mass.assign(bins.size(), 0);
    bins.integrate([&](std::size_t bin, Vec3 to, double solidAngle) {
        const BsdfEvaluation e = c.evaluate(to, ScatterEvent::Smooth);
        out.mass[bin] += c.pdf(e) * solidAngle;
        out.density += c.pdf(e) * solidAngle;
        out.energy += c.energy(e, to) * solidAngle;
    });
    for (const DeltaEvent& delta : deltas) {
        const BsdfEvaluation e = c.evaluate(delta.to, delta.event);
        out.deltaPmf.push_back(0);
        if (c.pdf(e) > 0) {
            // pdfW = pmf eta_to^2 |to.n|, f = coefficient eta_eye^2 x adjoint (bsdf.h)
            const bool toFront = dot(delta.to, c.bsdf.ng()) > 0;
            const bool transmits = delta.event == ScatterEvent::DeltaTransmission;
            const double etaTo2 = transmits ? std::pow(c.indexOn(toFront), 2) : 1.0;
            out.deltaPmf.back() = c.pdf(e) / (etaTo2 * delta.cosine);
            out.density += out.deltaPmf.back();
            out.energy += out.deltaPmf.back() * c.energy(e, delta.to) / c.pdf(e);
        }
    }
    return out;
}

void check(const Case& c, std::uint64_t seed, int samples, double significance) {
    SCOPED_TRACE(c.name);
    const TwoNormalBins bins(c);
    const std::vector<DeltaEvent> deltas = deltaEvents(c);
    const Integrals expected = integrate(c, bins, deltas);
    EXPECT_LE(expected.density, 1 + kQuadrature);
    if (c.side == Side::Eye || !c.tilted) {
        // The light walk's adjoint factor is unbounded.
        EXPECT_LE(expected.energy, 1 + kQuadrature);
    }

    // Counts: bins, delta events, empty draws.
    std::vector<double> counts(bins.size() + deltas.size() + 1, 0);
    Random random(seed);
    Moments weight;
    for (int i = 0; i < samples; ++i) {
        const float u0 = random.next(), u1 = random.next(), u2 = random.next();
        const auto s = c.bsdf.sample(c.side, c.from, u0, u1, u2);
        if (!s) {
            ++counts.back();
            weight.add(0);
            continue;
        }
        ASSERT_GT(c.pdf(s->evaluation), 0);
        weight.add(c.energy(s->evaluation, s->to) / c.pdf(s->evaluation));
        if (isDelta(s->event)) {
            // The sampled direction must be that of one of the events.
            std::size_t k = 0;
            while (k < deltas.size() &&
                   !(s->event == deltas[k].event && length(s->to - deltas[k].to) < 1e-3)) {
                ++k;
            }
            ASSERT_LT(k, deltas.size());
            ++counts[bins.size() + k];
        } else {
            const std::size_t bin = bins.binOf(s->to, double(random.next()));
            ASSERT_LT(bin, bins.size());
            ++counts[bin];
        }
    }

    // Chi-square. Bins with a small expectation are pooled; the quadrature's own error adds to each
    // bin's variance.
    double chi2 = 0, pooledExpected = 0, pooledCount = 0;
    int dof = -1;
    const auto compare = [&](double count, double expect, double quadratureError) {
        if (expect < 10) {
            pooledExpected += expect;
            pooledCount += count;
            return;
        }
        chi2 += (count - expect) * (count - expect) / (expect + quadratureError * quadratureError);
        ++dof;
    };
    for (std::size_t b = 0; b < bins.size(); ++b) {
        compare(counts[b], samples * expected.mass[b], 0.01 * samples * expected.mass[b]);
    }
    for (std::size_t k = 0; k < deltas.size(); ++k) {
        compare(counts[bins.size() + k], samples * expected.deltaPmf[k], 0);
    }
    compare(counts.back(), samples * std::max(0.0, 1 - expected.density), kQuadrature * samples);
    if (pooledExpected >= 10) {
        compare(pooledCount, pooledExpected, kQuadrature * samples);
    } else {
        EXPECT_LE(pooledCount,
                  pooledExpected + 8 * std::sqrt(pooledExpected + 1) + kQuadrature * samples);
    }
    if (dof > 0) {
        EXPECT_GT(chiSquareTail(chi2, dof), significance) << "chi2 " << chi2 << " of " << dof;
    }
    const double z = std::max(0.0, std::abs(weight.mean() - expected.energy) -
                                       kQuadrature * std::max(1.0, expected.energy)) /
                     std::max(1e-12, weight.standardError());
    EXPECT_GT(normalTail(z, 2), significance)
        << "weights " << weight.mean() << " +- " << weight.standardError() << ", quadrature "
        << expected.energy;
}

/// Checks every `stride`th case from `first` on. kAlarm is for `tests` cases.
void run(std::size_t first, std::size_t stride, std::size_t tests, int samples) {
    const std::vector<Case> cases = grid();
    for (std::size_t i = first; i < cases.size(); i += stride) {
        check(cases[i], 1000 + i, samples, sidak(kAlarm, 2.0 * double(tests)));
        if (::testing::Test::HasFatalFailure()) {
            return;
        }
    }
}

TEST(BsdfSampling, SamplesFollowTheDensity) {
    const std::size_t stride = 11;  // coprime to the grid's axes: meets every value of each
    run(0, stride, grid().size() / stride + 1, 20000);
}

class BsdfSamplingNight : public ::testing::TestWithParam<std::size_t> {};

constexpr std::size_t kQuarters = 4;

TEST_P(BsdfSamplingNight, SamplesFollowTheDensityOnTheWholeGrid) {
    run(GetParam(), kQuarters, grid().size(), 40000);
}

INSTANTIATE_TEST_SUITE_P(Quarters, BsdfSamplingNight, ::testing::Range<std::size_t>(0, kQuarters));

}  // namespace
}  // namespace lacuna::test

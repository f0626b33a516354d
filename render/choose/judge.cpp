// (theory.md, "auto")
#include "render/choose/judge.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libcore/image/smoothed.h"

namespace lacuna {
namespace {

constexpr double kEpsilon = 0.01;  // as in the error measures: e = 0.01 of the mean
/// A row replaces the usual one if its loss is below this share of the usual one's: trials are
/// noisy.
constexpr double kWorthAChange = 0.85;
constexpr int kRounds = 3;  // of computing weights from errors, and errors from weights

using Picture = std::vector<Vec3d>;

Vec3d channels(const Rgb& c) {
    return {double(c.r), double(c.g), double(c.b)};
}

Picture meanOf(const HalfPictures& halves) {
    Picture mean(halves.first.size());
    for (std::size_t i = 0; i < mean.size(); ++i) {
        mean[i] = (channels(halves.first[i]) + channels(halves.second[i])) * 0.5;
    }
    return mean;
}

/// The estimate R of the converged picture, the smoothed weighted mean of all pictures, and e.
struct Target {
    Picture around;
    double epsilon = 0.0;

    Target(std::span<const Picture> means, std::span<const double> weights, int width) {
        Picture sum(means[0].size());
        double total = 0.0, whole = 0.0;
        for (std::size_t n = 0; n < means.size(); ++n) {
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += means[n][i] * weights[n];
            total += weights[n];
        }
        for (Vec3d& v : sum) {
            v = v * (1.0 / total);
            whole += v[0] + v[1] + v[2];
        }
        epsilon = kEpsilon * whole / (3.0 * double(sum.size()));
        around = smoothed<Vec3d>(sum, width);
    }

    /// The mean of |a - b| / (R + e).
    template <class A, class B>
    double distance(const A& a, const B& b) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < around.size(); ++i) {
            const Vec3d difference = a(i) - b(i);
            for (int c = 0; c < 3; ++c) {
                const double d = std::fabs(difference[c]);
                if (d > 0.0) sum += d / (around[i][c] + epsilon);
            }
        }
        return sum / (3.0 * double(around.size()));
    }
};

}  // namespace

std::vector<double> errorsOf(std::span<const HalfPictures> pictures, int width) {
    const std::size_t n = pictures.size();
    std::vector<Picture> means;
    for (const HalfPictures& p : pictures) means.push_back(meanOf(p));
    std::vector<double> errors(n, 1.0), weights(n, 1.0);
    for (int round = 0; round < kRounds; ++round) {
        const Target target(means, weights, width);
        std::vector<double> seen(n), sums(n, 0.0);
        double all = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            seen[i] = 0.5 * target.distance(
                                [&](std::size_t p) { return channels(pictures[i].first[p]); },
                                [&](std::size_t p) { return channels(pictures[i].second[p]); });
            for (std::size_t j = 0; j < i; ++j) {
                const double d = target.distance([&](std::size_t p) { return means[i][p]; },
                                                 [&](std::size_t p) { return means[j][p]; });
                sums[i] += d;
                sums[j] += d;
                all += d;
            }
        }
        for (std::size_t i = 0; i < n; ++i) {
            // For three and more pictures the equations determine each error; two pictures share
            // their difference.
            const double own = n > 2    ? (sums[i] - all / double(n - 1)) / double(n - 2)
                               : n == 2 ? 0.5 * all
                                        : 0.0;
            errors[i] = std::max(seen[i], own);
            weights[i] = 1.0 / std::max(errors[i] * errors[i], 1e-12);
        }
    }
    return errors;
}

double errorWithout(std::span<const Rgb> part, const HalfPictures& picture, int width) {
    const Picture mean = meanOf(picture);
    const double one = 1.0;
    const Target target({&mean, 1}, {&one, 1}, width);
    return target.distance([&](std::size_t i) { return channels(part[i]); },
                           [](std::size_t) { return Vec3d{}; });
}

std::size_t rowToTake(std::span<const Verdict> verdicts, std::size_t usual) {
    // If the usual row has not seen some light, rows that have seen less do not know of it either:
    // the more of the picture is missing, the less a difference means.
    const double seen = std::max(0.0, 1.0 - verdicts[usual].error);
    std::size_t best = usual;
    double least = verdicts[usual].loss * kWorthAChange * seen;
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        const Verdict& v = verdicts[i];
        if (i == usual || !(v.loss < least)) continue;
        least = v.loss;
        best = i;
    }
    return best;
}

}  // namespace lacuna

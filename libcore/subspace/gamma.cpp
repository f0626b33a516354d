#include "libcore/subspace/gamma.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

constexpr std::size_t kPathsPerTask = 16384;
constexpr double kLeast = 1e-6;       // of an entry before the first step
constexpr double kLargestStep = 1.0;  // exponent a that is tried first
constexpr double kSafeStep = 0.5;     // the one that never raises the loss
constexpr double kConverged = 1e-7;   // relative fall of the loss by an epoch

std::size_t place(const GammaData& data, const GammaData::Entry& e) {
    return std::size_t(e.eye) * data.lightCount + e.light;
}

void normaliseColumns(SubspaceMatrix& matrix, std::uint32_t lightCount) {
    for (std::size_t begin = 0; begin < matrix.size(); begin += lightCount) {
        double sum = 0.0;
        for (std::size_t i = 0; i < lightCount; ++i) sum += matrix[begin + i];
        for (std::size_t i = 0; i < lightCount; ++i) {
            matrix[begin + i] = sum > 0.0 ? matrix[begin + i] / sum : 1.0 / lightCount;
        }
    }
}

}  // namespace

SubspaceMatrix fullGamma(const GammaData& data) {
    SubspaceMatrix q(std::size_t(data.lightCount) * data.eyeCount, 0.0);
    for (std::size_t p = 0; p < data.paths(); ++p) {
        for (const GammaData::Entry& e : data.entriesOf(p)) {
            q[place(data, e)] += double(data.contribution[p]);
        }
    }
    normaliseColumns(q, data.lightCount);
    for (double& v : q) v = std::max(v, kLeast);
    normaliseColumns(q, data.lightCount);
    return q;
}

SubspaceMatrix mixedGamma(const SubspaceMatrix& q, std::uint32_t lightCount) {
    SubspaceMatrix e(q.size());
    for (std::size_t n = 0; n < q.size(); ++n) {
        e[n] = (1.0 - kUniformShare) * q[n] + kUniformShare / lightCount;
    }
    return e;
}

double gammaLoss(const GammaData& data, const SubspaceMatrix& e, const ThreadPool& pool,
                 SubspaceMatrix* derivative) {
    if (derivative) derivative->assign(e.size(), 0.0);
    if (data.paths() == 0) return 0.0;
    const std::size_t tasks = (data.paths() + kPathsPerTask - 1) / kPathsPerTask;
    std::vector<double> sums(tasks, 0.0);
    std::vector<double> slope(derivative ? data.paths() : 0);  // f^2 / (p_D F^2), by path
    pool.forEach(tasks, [&](std::size_t task) {
        const std::size_t first = task * kPathsPerTask;
        for (std::size_t p = first; p < std::min(data.paths(), first + kPathsPerTask); ++p) {
            double f = double(data.fixed[p]);
            for (const GammaData::Entry& entry : data.entriesOf(p)) {
                f += double(entry.g) * e[place(data, entry)];
            }
            if (!(f > 0.0)) continue;
            const double c = double(data.contribution[p]);
            sums[task] += c * c / f;
            if (derivative) slope[p] = c * c / (f * f);
        }
    });
    const auto n = double(data.paths());
    double loss = 0.0;
    for (const double s : sums) loss += s / n;
    if (derivative) {
        // In the order of paths: the sums do not depend on threads.
        for (std::size_t p = 0; p < data.paths(); ++p) {
            for (const GammaData::Entry& entry : data.entriesOf(p)) {
                (*derivative)[place(data, entry)] -= slope[p] * double(entry.g) / n;
            }
        }
    }
    return loss;
}

GammaResult optimiseGamma(const GammaData& train, const GammaData& heldOut, SubspaceMatrix start,
                          int epochs, const ThreadPool& pool, const std::atomic<bool>& cancel) {
    const std::uint32_t rows = train.lightCount;
    GammaResult result;
    SubspaceMatrix q = std::move(start), derivative, next, nextDerivative;
    double loss = gammaLoss(train, mixedGamma(q, rows), pool, &derivative);
    result.gamma = mixedGamma(q, rows);
    result.trainLoss = {loss};
    result.heldOutLoss = {gammaLoss(heldOut, result.gamma, pool)};

    double exponent = kLargestStep;
    for (int epoch = 1; epoch <= epochs; ++epoch) {
        double nextLoss = 0.0;
        for (;;) {
            if (cancel) throw Error(130, "interrupted: nothing was written");
            next.resize(q.size());
            for (std::size_t n = 0; n < q.size(); ++n) {
                next[n] = q[n] * std::pow(std::max(-derivative[n], 0.0), exponent);
            }
            // A column that nothing depends on stays as it is.
            for (std::size_t begin = 0; begin < q.size(); begin += rows) {
                const auto column = derivative.begin() + std::ptrdiff_t(begin);
                if (std::all_of(column, column + rows, [](double d) { return d == 0.0; })) {
                    std::copy_n(q.begin() + std::ptrdiff_t(begin), rows,
                                next.begin() + std::ptrdiff_t(begin));
                }
            }
            normaliseColumns(next, rows);
            nextLoss = gammaLoss(train, mixedGamma(next, rows), pool, &nextDerivative);
            if (nextLoss <= loss || exponent <= kSafeStep) break;
            exponent = std::max(kSafeStep, 0.5 * (exponent + kSafeStep) - 0.05);
        }
        const double fall = loss - nextLoss;
        std::swap(q, next);
        std::swap(derivative, nextDerivative);
        loss = nextLoss;
        const SubspaceMatrix e = mixedGamma(q, rows);
        result.trainLoss.push_back(loss);
        result.heldOutLoss.push_back(gammaLoss(heldOut, e, pool));
        const std::vector<double>& judge =
            heldOut.paths() > 0 ? result.heldOutLoss : result.trainLoss;
        if (judge.back() < judge[result.kept]) {
            result.kept = result.trainLoss.size() - 1;
            result.gamma = e;
        }
        if (!(fall > kConverged * loss)) break;
    }
    return result;
}

}  // namespace lacuna

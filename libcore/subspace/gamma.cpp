// (theory.md, "Subspaces")
#include "libcore/subspace/gamma.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

constexpr std::size_t kPathsPerTask = 16384;
constexpr double kLeast = 1e-6;      // of an entry before the first step
constexpr double kConverged = 1e-7;  // relative fall of the loss by an epoch
constexpr int kPatience = 3;         // epochs after the kept one before giving up
constexpr double kVirtualPaths[] = {1, 3, 10, 30, 100, 300, 1000, 3000, 10000};
constexpr std::size_t kLightNeighbours = 4;

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

/// The first `most` of the neighbours.
std::span<const std::uint32_t> nearest(const std::vector<std::uint32_t>& neighbours,
                                       std::size_t most) {
    return std::span(neighbours).first(std::min(most, neighbours.size()));
}

/// a^l: the columns of the `most` nearest eye subspaces together, weighted by their paths. Light
/// subspaces have the ratio to m^0 in common with the nearest of theirs.
GammaColumns neighbourhoods(const FullGamma& full, const SubspaceNeighbours& neighbours,
                            std::size_t most, const ThreadPool& pool) {
    const std::size_t rows = full.mean.size();
    GammaColumns around;
    around.q.resize(full.q.size());
    around.paths.resize(full.paths.size());
    pool.forEach(full.paths.size(), [&](std::size_t j) {
        std::vector<double> sum(rows, 0.0);
        for (const std::uint32_t k : nearest(neighbours.eye[j], most)) {
            around.paths[j] += full.paths[k];
            const double* column = full.q.data() + k * rows;
            for (std::size_t i = 0; i < rows; ++i) sum[i] += full.paths[k] * column[i];
        }
        for (std::size_t i = 0; i < rows; ++i) {
            double together = 0.0, mean = 0.0;
            for (const std::uint32_t k : nearest(neighbours.light[i], kLightNeighbours)) {
                together += sum[k];
                mean += full.mean[k];
            }
            around.q[j * rows + i] = full.mean[i] * together / mean;
        }
    });
    normaliseColumns(around.q, std::uint32_t(rows));
    return around;
}

}  // namespace

FullGamma fullGamma(const GammaData& data) {
    FullGamma full;
    full.q.assign(std::size_t(data.lightCount) * data.eyeCount, 0.0);
    full.mean.assign(data.lightCount, 0.0);
    std::vector<double> sum(data.eyeCount, 0.0), squares(data.eyeCount, 0.0);
    for (std::size_t p = 0; p < data.paths(); ++p) {
        const auto c = double(data.contribution[p]);
        for (const GammaData::Entry& e : data.entriesOf(p)) {
            full.q[place(data, e)] += c;
            full.mean[e.light] += c;
            sum[e.eye] += c;
            squares[e.eye] += c * c;
        }
    }
    for (std::size_t j = 0; j < sum.size(); ++j) {
        full.paths.push_back(squares[j] > 0.0 ? sum[j] * sum[j] / squares[j] : 0.0);
    }
    for (SubspaceMatrix* q : {&full.q, &full.mean}) {
        normaliseColumns(*q, data.lightCount);
        for (double& v : *q) v = std::max(v, kLeast);
        normaliseColumns(*q, data.lightCount);
    }
    return full;
}

FullGamma fullGamma(const GammaData& data, const SubspaceNeighbours& neighbours,
                    const ThreadPool& pool) {
    FullGamma full = fullGamma(data);
    for (const std::size_t most : kNeighbourhoods) {
        full.around.push_back(neighbourhoods(full, neighbours, most, pool));
    }
    return full;
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

namespace {

/// `columns` with `virtualPaths` of `prior` in each: (n q + kappa m) / (n + kappa).
SubspaceMatrix drawnTo(const SubspaceMatrix& prior, const GammaColumns& columns,
                       double virtualPaths) {
    SubspaceMatrix q = columns.q;
    const std::size_t rows = q.size() / columns.paths.size();
    for (std::size_t j = 0; j < columns.paths.size(); ++j) {
        const double paths = columns.paths[j];
        const double own = paths > 0.0 ? paths / (paths + virtualPaths) : 0.0;
        for (std::size_t n = j * rows; n < (j + 1) * rows; ++n) {
            q[n] = own * q[n] + (1.0 - own) * prior[n];
        }
    }
    return q;
}

/// m: the prior that every column is drawn to.
SubspaceMatrix priorOf(const FullGamma& full, double virtualPaths) {
    SubspaceMatrix m(full.q.size());
    for (std::size_t n = 0; n < m.size(); ++n) m[n] = full.mean[n % full.mean.size()];
    for (const GammaColumns& around : full.around) m = drawnTo(m, around, virtualPaths);
    return m;
}

/// sum_j lambda_j sum_i m_ij^2 / E_ij.
class Penalty {
  public:
    Penalty(const FullGamma& full, SubspaceMatrix prior, double virtualPaths,
            const SubspaceMatrix& e, const SubspaceMatrix& derivative)
        : rows_(full.mean.size()), prior_(std::move(prior)), lambda_(full.paths.size(), 0.0) {
        for (std::size_t n = 0; n < e.size(); ++n) {
            const std::size_t j = n / rows_;
            if (full.paths[j] > 0.0) {
                lambda_[j] -= virtualPaths / full.paths[j] * e[n] * derivative[n];
            }
        }
    }

    /// Returns its value, and adds its derivative to `derivative`.
    double addTo(SubspaceMatrix& derivative, const SubspaceMatrix& e) const {
        double value = 0.0;
        for (std::size_t n = 0; n < e.size(); ++n) {
            const double v = lambda_[n / rows_] * prior_[n] * prior_[n] / e[n];
            value += v;
            derivative[n] -= v / e[n];
        }
        return value;
    }

  private:
    std::size_t rows_;
    SubspaceMatrix prior_;
    std::vector<double> lambda_;
};

}  // namespace

GammaResult optimiseGamma(const GammaData& train, const GammaData& heldOut, const FullGamma& full,
                          const GammaSettings& settings, const ThreadPool& pool,
                          const std::atomic<bool>& cancel) {
    const std::uint32_t rows = train.lightCount;
    GammaResult result;
    SubspaceMatrix q = full.q, derivative, next, nextDerivative;
    result.gamma = mixedGamma(q, rows);
    result.fullTrainLoss = gammaLoss(train, result.gamma, pool);
    result.fullHeldOutLoss = gammaLoss(heldOut, result.gamma, pool);
    double least = result.fullHeldOutLoss;
    for (const double virtualPaths : kVirtualPaths) {
        if (heldOut.paths() == 0 || !settings.borrow) break;
        SubspaceMatrix drawn = drawnTo(priorOf(full, virtualPaths), full, virtualPaths);
        SubspaceMatrix e = mixedGamma(drawn, rows);
        const double loss = gammaLoss(heldOut, e, pool);
        if (!(loss < least)) continue;
        least = loss;
        result.virtualPaths = virtualPaths;
        q = std::move(drawn);
        result.gamma = std::move(e);
    }
    result.trainLoss = {gammaLoss(train, result.gamma, pool, &derivative)};
    result.heldOutLoss = {least};
    const Penalty penalty(full, priorOf(full, result.virtualPaths), result.virtualPaths,
                          result.gamma, derivative);
    double loss = result.trainLoss[0] + penalty.addTo(derivative, result.gamma);

    for (int epoch = 1; epoch <= settings.epochs; ++epoch) {
        if (cancel) throw InterruptedError("interrupted: nothing was written");
        next.resize(q.size());
        for (std::size_t n = 0; n < q.size(); ++n) {
            next[n] = q[n] * std::sqrt(std::max(-derivative[n], 0.0));
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
        const SubspaceMatrix e = mixedGamma(next, rows);
        const double trainLoss = gammaLoss(train, e, pool, &nextDerivative);
        const double nextLoss = trainLoss + penalty.addTo(nextDerivative, e);
        const double fall = loss - nextLoss;
        std::swap(q, next);
        std::swap(derivative, nextDerivative);
        loss = nextLoss;
        result.trainLoss.push_back(trainLoss);
        result.heldOutLoss.push_back(gammaLoss(heldOut, e, pool));
        const std::vector<double>& judge =
            heldOut.paths() > 0 ? result.heldOutLoss : result.trainLoss;
        if (judge.back() < judge[result.kept]) {
            result.kept = result.trainLoss.size() - 1;
            result.gamma = e;
        }
        if (!(fall > kConverged * loss) || epoch >= int(result.kept) + kPatience) break;
    }
    return result;
}

}  // namespace lacuna

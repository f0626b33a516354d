// (theory.md, "Importance records")
#include "libcore/resampling/importance_records.h"

#include <algorithm>

#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

/// G falls with the square of the distance: four times as far is a sixteenth.
constexpr double kBoundedShare = 1.0 / 16.0;

/// The columns that weights read of a record and a length: Q of the four distributions, then Z.
constexpr std::uint32_t kMaxima = ImportanceRecords::kDistributions;
constexpr int kColumns = ImportanceRecords::kDistributions + 1;
/// N_q: records of the earlier iteration whose sums a new record reads, as for cache points.
constexpr int kEarlierRecords = 3;
/// Lengths with means of their own. Longer light subpaths share those of the last one.
constexpr int kLengths = 8;

}  // namespace

ImportanceRecords::ImportanceRecords(const Options& options)
    : options_(options), earlier_(kLengths * kColumns, 1, kEarlierRecords) {}

double ImportanceRecords::samplesOf(const Connection& c, std::uint32_t serving,
                                    double picks) const {
    const auto around = points_.around(serving);
    if (around.empty()) return picks;
    const auto perSubpath = 1.0 / double(options_.subpaths);
    const Rgb arriving = c.beta * c.light.scatter;
    const double flow = double(mean(arriving));
    const double through = double(mean(arriving * c.eye.scatter));
    const int length = std::min(c.light.count, kLengths) - 1;
    double sum = 0.0;
    for (const std::uint32_t i : around) {
        const double* q = &learnt_[(std::size_t(i) * kLengths + std::size_t(length)) * kColumns];
        // A length that was never seen: one sample per pick is as good a guess as any.
        if (!(q[kUniform] > 0.0)) {
            sum += picks;
            continue;
        }
        const double g = points_.trustedGeometry(i, *c.light.vertex, c.geometry);
        const double bounded = points_.limited(i, *c.light.vertex, g, kBoundedShare);
        double ratio = 1.0 / q[kUniform];
        if (q[kFull] > 0.0) ratio = std::max(ratio, through * g / q[kFull]);
        if (q[kUnoccluded] > 0.0) ratio = std::max(ratio, through * g / q[kUnoccluded]);
        if (q[kBounded] > 0.0) ratio = std::max(ratio, flow * bounded / q[kBounded]);
        ratio /= q[kMaxima];
        sum += 1.0 / (perSubpath + (1.0 - perSubpath) / (picks * ratio));
    }
    return sum / double(around.size());
}

void ImportanceRecords::prepare(const VerticesByLength& vertices, IterationContext& context) {
    PhaseTimer timer(context.statistics, "record distributions");
    vertices_ = &vertices;
    const auto lengths = std::size_t(vertices.lengths()) + 1;
    pmfs_.assign(points_.size() * lengths, {});
    found_.assign(points_.size() * kLengths * kColumns, 0.0);
    std::vector<RayTally> tallies(points_.size());
    context.threads.forEach(points_.size(), [&](std::size_t r) {
        std::vector<double> weight[kDistributions];
        for (auto& w : weight) w.assign(vertices.size(), 0.0);
        weigh(std::uint32_t(r), context.space, tallies[r], weight);
        for (std::size_t s = 1; s < lengths; ++s) {
            std::span<const double> targets[kDistributions];
            for (std::size_t i = 0; i < kDistributions; ++i) {
                targets[i] =
                    std::span(weight[i]).subspan(vertices.begin(int(s)), vertices.count(int(s)));
            }
            const CombinedPmf& pmf = pmfs_[r * lengths + s] = CombinedPmf(targets);
            if (s > kLengths) continue;
            double* found = &found_[(r * kLengths + s - 1) * kColumns];
            for (std::size_t i = 0; i < kDistributions; ++i) {
                found[i] = pmf.sum(i) / double(options_.subpaths);
            }
            found[kMaxima] = pmf.maxima();
        }
    });
    for (const RayTally& t : tallies) context.statistics.add(t);
    context.statistics.hold("record distribution bytes", bytesOf(pmfs_));
    context.statistics.hold("importance records", points_.size());
    context.statistics.hold("importance record bytes", points_.bytes());
}

ImportanceRecords::Pick ImportanceRecords::pick(std::uint32_t serving, int s, double u,
                                                Rng& rng) const {
    const auto around = points_.around(serving);
    if (around.empty()) {
        const auto count = double(vertices_->count(s));
        return {vertices_->begin(s) + std::size_t(u * count), 1.0 / count, kDistributions};
    }
    const auto lengths = std::size_t(vertices_->lengths()) + 1;
    const auto pmfOf = [&](std::uint32_t record) -> const CombinedPmf& {
        return pmfs_[record * lengths + std::size_t(s)];
    };
    // No pmf is empty: uniform is always one of the four.
    const CombinedPmf& chosen = pmfOf(around[rng.below(std::uint32_t(around.size()))]);
    const std::uint32_t index = chosen.sample(u).index;
    double sum = 0.0;
    for (const std::uint32_t record : around) sum += pmfOf(record).pmf(index);
    return {vertices_->begin(s) + index, sum / double(around.size()), chosen.owner(index)};
}

void ImportanceRecords::observe(IterationContext& context) {
    PhaseTimer timer(context.statistics, "importance records");
    CachePoints next(context, options_.density, options_.records, context.generation);
    if (options_.aware) {
        earlier_.add(std::move(points_), std::move(found_));
        learnt_ = earlier_.at(next, context.threads);
    }
    points_ = std::move(next);
}

void ImportanceRecords::weigh(std::uint32_t record, const PathSpace& space, RayTally& tally,
                              std::vector<double> (&weight)[kDistributions]) const {
    const Subpath eye = points_.eye(record);
    for (std::size_t i = 0; i < vertices_->size(); ++i) {
        weight[kUniform][i] = 1.0;
        const Subpath light = vertices_->prefix(i);
        const PathSpace::Arrival a = space.arrival(light, eye, true);
        const double flow = double(mean(a.flow));
        if (!(flow > 0.0)) continue;
        const auto g = [&](double share) {
            return points_.limited(record, light.back(), a.geometry, share);
        };
        weight[kBounded][i] = flow * g(kBoundedShare);
        const double full = double(mean(a.scattered)) * g(1.0);
        weight[kUnoccluded][i] = full;
        if (full > 0.0 && space.visible(light.back(), eye.back(), tally)) {
            weight[kFull][i] = full;
        }
    }
}

}  // namespace lacuna

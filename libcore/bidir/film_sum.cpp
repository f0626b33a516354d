// (theory.md, "Blocks")
#include "libcore/bidir/film_sum.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "libcore/base/parallel.h"
#include "libcore/bidir/error_estimate.h"
#include "libcore/image/channels.h"

namespace lacuna {
namespace {

constexpr std::size_t kPixelsPerTask = 1 << 14;

/// Calls body(first, end) for pieces of kPixelsPerTask pixels.
template <class Body>
void forPieces(std::size_t pixels, const ThreadPool* threads, const Body& body) {
    const std::size_t tasks = (pixels + kPixelsPerTask - 1) / kPixelsPerTask;
    const auto piece = [&](std::size_t task) {
        body(task * kPixelsPerTask, std::min(pixels, (task + 1) * kPixelsPerTask));
    };
    if (threads && tasks > 1) {
        threads->forEach(tasks, piece);
    } else {
        for (std::size_t task = 0; task < tasks; ++task) piece(task);
    }
}

/// Joins the means and spreads of two sums. Only the results are rounded to float. The loops have no
/// branches: they run over several numbers at once.
struct Joint {
    Joint(const FilmSum& left, const FilmSum& right, SumRelation relation)
        : nLeft(double(left.iterations)),
          nRight(double(right.iterations)),
          between(relation == SumRelation::OfAlikeSample ? 0.0
                                                         : nLeft * nRight / (nLeft + nRight)) {}

    double mean(double left, double right) const {
        return (nLeft * left + nRight * right) / (nLeft + nRight);
    }
    double squares(double left, double right, double distance) const {
        return left + right + between * distance * distance;
    }
    void joinMeans(std::span<float> means, std::span<const float> means2) const {
        for (std::size_t i = 0; i < means.size(); ++i) {
            means[i] = float(mean(double(means[i]), double(means2[i])));
        }
    }
    /// To be called before the means are joined. `spread2` may be empty.
    void joinSpreads(std::span<float> spread, std::span<const float> spread2,
                     std::span<const float> means, std::span<const float> means2) const {
        const auto joinAll = [&](const auto& right) {
            for (std::size_t i = 0; i < spread.size(); ++i) {
                const double s = double(spread[i]), s2 = right(i);
                spread[i] =
                    float(std::sqrt(squares(s * s, s2 * s2, double(means2[i]) - double(means[i]))));
            }
        };
        if (spread2.empty()) {
            joinAll([](std::size_t) { return 0.0; });
        } else {
            joinAll([&](std::size_t i) { return double(spread2[i]); });
        }
    }

    const double nLeft, nRight;
    const double between;  ///< weight of the squared distance of the two means
};

/// A copy, with or without the layers.
FilmSum copyOf(const FilmSum& sum, Layered layered) {
    if (layered == Layered::Yes) return sum;
    return {sum.iterations, sum.samples,      sum.mean, sum.spread,
            sum.wholeMean,  sum.wholeSquares, {},       sum.differences};
}

void joinLayers(FilmSum& left, const FilmSum& right, const Joint& joint) {
    const std::size_t pixels = left.mean.size();
    for (const auto& [name, plane] : right.layers) left.layers[name].resize(pixels);
    const std::vector<float> none(pixels);
    for (auto& [name, plane] : left.layers) {
        const auto found = right.layers.find(name);
        const std::vector<float>& other = found == right.layers.end() ? none : found->second;
        for (std::size_t i = 0; i < pixels; ++i) {
            plane[i] = float(joint.mean(double(plane[i]), double(other[i])));
        }
    }
}

void addDifference(std::vector<HalfDifference>& list, const HalfDifference& d) {
    const auto place =
        std::ranges::lower_bound(list, d.iterations, {}, &HalfDifference::iterations);
    if (place == list.end() || place->iterations != d.iterations) {
        list.insert(place, d);
        return;
    }
    place->nodes += d.nodes;
    place->sum += d.sum;
    place->squares += d.squares;
    place->unevenness += d.unevenness;
}

double varianceOfMean(double squares, double divisor) {
    if (divisor == 0.0) return 0.0;
    return std::max(0.0, squares / divisor);  // also where it is NaN
}

}  // namespace

FilmSum FilmSum::ofIteration(std::span<const Rgb> pixels, int width, const ThreadPool& threads) {
    FilmSum sum;
    sum.iterations = sum.samples = 1;
    sum.mean.assign(pixels.begin(), pixels.end());
    const auto row = std::size_t(width);
    std::vector<Vec3d> rows(pixels.size() / row);
    threads.forEach(rows.size(), [&](std::size_t y) {
        for (const Rgb& p : pixels.subspan(y * row, row)) rows[y] += Vec3d{p.r, p.g, p.b};
    });
    Vec3d total;
    for (const Vec3d& r : rows) total += r;
    for (std::size_t c = 0; c < 3; ++c) sum.wholeMean[c] = total[c] / double(pixels.size());
    return sum;
}

Image FilmSum::image(int width, int height) const {
    Image image(width, height);
    if (iterations > 0) image.pixels = mean;
    return image;
}

double FilmSum::varianceDivisor() const {
    const std::uint64_t known = samples == 1 && !spread.empty() ? iterations : samples;
    return known < 2 ? 0.0 : double(iterations) * double(known - 1);
}

Image FilmSum::variance(int width, int height) const {
    Image image(width, height);
    const double divisor = varianceDivisor();
    const auto of = [&](float s) { return float(varianceOfMean(double(s) * double(s), divisor)); };
    for (std::size_t i = 0; i < spread.size(); ++i) {
        image.pixels[i] = {of(spread[i].r), of(spread[i].g), of(spread[i].b)};
    }
    return image;
}

FilmSum::MeanColour FilmSum::meanColour() const {
    MeanColour m;
    for (std::size_t c = 0; c < 3; ++c) {
        m.mean[c] = wholeMean[c];
        m.standardError[c] = std::sqrt(varianceOfMean(wholeSquares[c], varianceDivisor()));
    }
    return m;
}

void join(FilmSum& left, const FilmSum& right, SumRelation relation, const ThreadPool* threads,
          Layered layered) {
    if (right.iterations == 0) return;
    if (left.iterations == 0) {
        left = copyOf(right, layered);
        return;
    }
    const Joint joint(left, right, relation);
    const auto isForgotten = [&](const FilmSum& sum) {
        return relation == SumRelation::Samples && sum.samples == 1;
    };
    if (isForgotten(left)) {
        left.spread.clear();
        left.wholeSquares = {};
    }
    const bool isKept = !isForgotten(right), hasRight = isKept && !right.spread.empty();
    const bool spreads = relation != SumRelation::OfAlikeSample || !left.spread.empty() || hasRight;
    if (spreads) left.spread.resize(left.mean.size());
    forPieces(left.mean.size(), threads, [&](std::size_t first, std::size_t end) {
        const auto pieceOf = [&](auto& pixels) {
            return channelsOf(std::span(pixels).subspan(first, end - first));
        };
        const auto means = pieceOf(left.mean);
        const auto means2 = pieceOf(right.mean);
        if (spreads) {
            std::span<const float> spread2;
            if (hasRight) spread2 = pieceOf(right.spread);
            joint.joinSpreads(pieceOf(left.spread), spread2, means, means2);
        }
        joint.joinMeans(means, means2);
    });
    for (std::size_t c = 0; c < 3; ++c) {
        left.wholeSquares[c] =
            joint.squares(left.wholeSquares[c], isKept ? right.wholeSquares[c] : 0.0,
                          right.wholeMean[c] - left.wholeMean[c]);
        left.wholeMean[c] = joint.mean(left.wholeMean[c], right.wholeMean[c]);
    }
    if (layered == Layered::Yes) joinLayers(left, right, joint);
    for (const HalfDifference& d : right.differences) addDifference(left.differences, d);
    left.iterations += right.iterations;
    left.samples = relation == SumRelation::Samples ? left.samples + right.samples : 1;
}

void SumTree::measure(const ErrorMeter* meter, std::uint64_t first, std::uint64_t iterations) {
    meter_ = meter;
    first_ = first;
    itemIterations_ = iterations;
}

void SumTree::add(Node node, const ThreadPool* threads) {
    nodes_.push_back(std::move(node));
    while (nodes_.size() >= 2) {
        const Node &left = nodes_[nodes_.size() - 2], &right = nodes_.back();
        const bool siblings = left.size == right.size && left.begin + left.size == right.begin &&
                              left.begin % (2 * left.size) == 0;
        if (!siblings) return;
        joinLast(threads);
    }
}

/// Joins the last two nodes, which are siblings.
void SumTree::joinLast(const ThreadPool* threads) {
    Node &left = nodes_[nodes_.size() - 2], &right = nodes_.back();
    if (left.sum.use_count() > 1) left.sum = std::make_shared<FilmSum>(*left.sum);
    std::atomic_thread_fence(std::memory_order_acquire);  // former holders have read it
    // A node's content depends on its range alone, not on who makes it. Only halves of the same
    // size are compared: the last block may have fewer iterations than others.
    const bool even = left.sum->iterations == right.sum->iterations;
    const SumRelation relation = 2 * left.size <= sampleItems_ ? within_ : SumRelation::Samples;
    const std::uint64_t end = first_ + (right.begin + right.size) * itemIterations_;
    std::optional<HalfDifference> difference;
    if (meter_ && even && ErrorMeter::wants(2 * left.sum->iterations, end)) {
        difference = meter_->difference(*left.sum, *right.sum, threads);
    }
    join(*left.sum, *right.sum, relation, threads);
    if (difference) addDifference(left.sum->differences, *difference);
    left.size *= 2;
    nodes_.pop_back();
}

void SumTree::addTo(FilmSum& sum, const ThreadPool* threads, Layered layered) const {
    // The last nodes, smaller than a sample, together are the sample that is not whole yet.
    FilmSum last;
    for (const Node& node : nodes_) {
        const bool whole = node.size >= sampleItems_;
        join(whole ? sum : last, *node.sum, whole ? SumRelation::Samples : within_, threads,
             layered);
    }
    join(sum, last, SumRelation::Samples, threads, layered);
}

}  // namespace lacuna

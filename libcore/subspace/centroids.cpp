#include "libcore/subspace/centroids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace lacuna {

Centroids::Centroids(std::span<const SubpathEnd> centres, float sigma2, float directionWeight)
    : size_(centres.size()),
      sigma2_(sigma2),
      directionWeight_(directionWeight),
      value_(SubpathEnd::kAttributes * centres.size()) {
    for (std::size_t a = 0; a < SubpathEnd::kAttributes; ++a) {
        for (std::size_t i = 0; i < size_; ++i) value_[a * size_ + i] = centres[i].value[a];
    }
}

float Centroids::distance(std::size_t index, const SubpathEnd& end) const {
    const float* c = value_.data() + index;
    const auto& p = end.value;
    const float x = p[0] - c[0], y = p[1] - c[size_], z = p[2] - c[2 * size_];
    const float cosN = p[3] * c[3 * size_] + p[4] * c[4 * size_] + p[5] * c[5 * size_];
    const float cosD = p[6] * c[6 * size_] + p[7] * c[7 * size_] + p[8] * c[8 * size_];
    return x * x + y * y + z * z +
           sigma2_ * ((1.0f - cosN) + directionWeight_ * (1.0f - cosD));  // [Su22 eq 18]
}

std::uint32_t Centroids::nearest(const SubpathEnd& end) const {
    // Distances are computed in blocks: that loop has no branch and becomes vector instructions, as
    // long as the index cannot wrap around (std::size_t).
    constexpr std::size_t kBlock = 64;
    float best = std::numeric_limits<float>::infinity();
    std::uint32_t found = 0;
    std::array<float, kBlock> d;
    for (std::size_t begin = 0; begin < size_; begin += kBlock) {
        const std::size_t n = std::min(kBlock, size_ - begin);
        for (std::size_t i = 0; i < n; ++i) d[i] = distance(begin + i, end);
        for (std::size_t i = 0; i < n; ++i) {
            if (d[i] < best) {
                best = d[i];
                found = std::uint32_t(begin + i);
            }
        }
    }
    return found;
}

std::vector<std::uint32_t> Centroids::nearest(const SubpathEnd& end, std::size_t most) const {
    std::vector<std::pair<float, std::uint32_t>> all;
    all.reserve(size_);
    for (std::uint32_t i = 0; i < size_; ++i) all.emplace_back(distance(i, end), i);
    const auto last = all.begin() + std::ptrdiff_t(std::min(most, size_));
    std::partial_sort(all.begin(), last, all.end());
    std::vector<std::uint32_t> found;
    for (auto a = all.begin(); a != last; ++a) found.push_back(a->second);
    return found;
}

float spatialVariance(std::span<const SubpathEnd> ends) {
    if (ends.empty()) return 0.0f;
    double sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
    // Moments are about the first end: no cancellation far from the origin.
    for (const SubpathEnd& e : ends) {
        for (std::size_t a = 0; a < 3; ++a) {
            const double d = double(e.value[a]) - double(ends[0].value[a]);
            sum[a] += d;
            squares[a] += d * d;
        }
    }
    const auto n = double(ends.size());
    double largest = 0.0;
    for (int a = 0; a < 3; ++a) {
        const double mean = sum[a] / n;
        largest = std::max(largest, squares[a] / n - mean * mean);
    }
    return float(largest);
}

std::vector<SubpathEnd> drawCentroids(std::span<const SubpathEnd> ends,
                                      std::span<const float> weights, std::size_t count, Rng& rng) {
    const auto weightOf = [&](std::size_t i) {
        return std::isfinite(weights[i]) && weights[i] > 0.0f ? double(weights[i]) : 0.0;
    };
    double total = 0.0;
    for (std::size_t i = 0; i < ends.size(); ++i) total += weightOf(i);
    std::vector<SubpathEnd> drawn;
    if (!(total > 0.0)) return drawn;
    std::set<std::array<float, SubpathEnd::kAttributes>> known;
    double before = 0.0;
    std::size_t stratum = 0;
    double next = rng.uniformDouble();  // in strata
    for (std::size_t i = 0; i < ends.size() && stratum < count; ++i) {
        before += weightOf(i);
        const double reached = before / total * double(count);
        while (stratum < count && next < reached) {
            if (known.insert(ends[i].value).second) drawn.push_back(ends[i]);
            ++stratum;
            next = double(stratum) + rng.uniformDouble();
        }
    }
    return drawn;
}

}  // namespace lacuna

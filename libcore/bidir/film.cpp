#include "libcore/bidir/film.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "libcore/base/parallel.h"

namespace lacuna {

std::uint64_t addSplats(std::span<const std::vector<Splat>> chunks, std::span<Rgb> pixels,
                        const ThreadPool& pool) {
    // Each band of pixels walks all lists in order: which band a pixel is in changes nothing.
    const std::size_t bands = std::size_t(pool.threads());
    std::vector<std::uint64_t> leftOut(bands, 0);
    pool.forEach(bands, [&](std::size_t band) {
        const auto low = std::uint32_t(pixels.size() * band / bands);
        const auto high = std::uint32_t(pixels.size() * (band + 1) / bands);
        for (const std::vector<Splat>& chunk : chunks) {
            for (const Splat& s : chunk) {
                if (s.pixel < low || s.pixel >= high) continue;
                const Rgb sum = pixels[s.pixel] + s.value;
                if (isFinite(sum)) {
                    pixels[s.pixel] = sum;
                } else {
                    ++leftOut[band];
                }
            }
        }
    });
    return std::accumulate(leftOut.begin(), leftOut.end(), std::uint64_t(0));
}

Film::Film(int width, int height)
    : width_(width),
      height_(height),
      sum_(std::size_t(width) * height),
      sumOfSquares_(std::size_t(width) * height) {}

void Film::add(std::span<const Rgb> pixels, const ThreadPool& pool) {
    ++iterations_;
    std::vector<Vec3d> rowSums(std::size_t(height_), Vec3d{});
    pool.forEach(std::size_t(height_), [&](std::size_t y) {
        for (std::size_t i = y * width_; i < (y + 1) * width_; ++i) {
            const Vec3d v{pixels[i].r, pixels[i].g, pixels[i].b};
            sum_[i] += v;
            sumOfSquares_[i] += Vec3d{v.x * v.x, v.y * v.y, v.z * v.z};
            rowSums[y] += v;
        }
    });
    Vec3d total;
    for (const Vec3d& row : rowSums) total += row;
    for (std::size_t c = 0; c < 3; ++c) {
        const double m = total[c] / double(sum_.size());
        meanSum_[c] += m;
        meanSquares_[c] += m * m;
    }
}

Image Film::image() const {
    Image image(width_, height_);
    if (iterations_ == 0) return image;
    const double scale = 1.0 / double(iterations_);
    for (std::size_t i = 0; i < sum_.size(); ++i) {
        image.pixels[i] = {float(sum_[i].x * scale), float(sum_[i].y * scale),
                           float(sum_[i].z * scale)};
    }
    return image;
}

namespace {
/// Variance of the mean of n samples from their sum and sum of squares.
double varianceOfMean(double sum, double squares, double n) {
    return n < 2.0 ? 0.0 : std::max(0.0, (squares - sum * sum / n) / (n * (n - 1.0)));
}
}  // namespace

Image Film::variance() const {
    Image image(width_, height_);
    const double n = double(iterations_);
    for (std::size_t i = 0; i < sum_.size(); ++i) {
        const auto of = [&](std::size_t c) {
            return float(varianceOfMean(sum_[i][c], sumOfSquares_[i][c], n));
        };
        image.pixels[i] = {of(0), of(1), of(2)};
    }
    return image;
}

Film::MeanColour Film::meanColour() const {
    MeanColour m;
    const double n = double(iterations_);
    for (int c = 0; c < 3; ++c) {
        m.mean[c] = n > 0.0 ? meanSum_[c] / n : 0.0;
        m.standardError[c] = std::sqrt(varianceOfMean(meanSum_[c], meanSquares_[c], n));
    }
    return m;
}

TechniqueFilm::TechniqueFilm(int width, int height, int maxDepth)
    : width_(width), height_(height), maxDepth_(maxDepth) {
    const std::size_t techniques = indexOf(0, maxDepth + 1) + std::size_t(maxDepth) + 1;
    layers_.assign(2 * techniques, std::vector<Rgb>(std::size_t(width) * height));
}

std::string TechniqueFilm::layerName(int s, int t) {
    char name[32];
    std::snprintf(name, sizeof name, "s%02dt%02d", s, t);
    return name;
}

std::size_t TechniqueFilm::indexOf(int s, int t) const {
    // Paths of k = s + t - 1 edges have k + 1 techniques, s = 0 .. k.
    const int k = s + t - 1;
    return std::size_t(k - 1) * std::size_t(k + 2) / 2 + std::size_t(s);
}

void TechniqueFilm::add(int s, int t, std::uint32_t pixel, const Rgb& weighted,
                        const Rgb& unweighted) {
    const std::size_t i = 2 * indexOf(s, t);
    layers_[i][pixel] += weighted;
    layers_[i + 1][pixel] += unweighted;
}

Image TechniqueFilm::mean(int s, int t, bool unweighted) const {
    Image image(width_, height_);
    const std::vector<Rgb>& layer = layers_[2 * indexOf(s, t) + (unweighted ? 1 : 0)];
    const float scale = iterations_ ? 1.0f / float(iterations_) : 0.0f;
    for (std::size_t i = 0; i < layer.size(); ++i) image.pixels[i] = layer[i] * scale;
    return image;
}

void TechniqueFilm::writeTo(LayeredImage& image) const {
    const std::size_t pixels = std::size_t(width_) * std::size_t(height_);
    std::vector<double> total(pixels, 0.0), first(pixels, 0.0);  // of the channels, over layers
    for (int k = 1; k <= maxDepth_; ++k) {
        for (int s = 0; s <= k; ++s) {
            const int t = k + 1 - s;
            const std::vector<Rgb>& weighted = layers_[2 * indexOf(s, t) + 1];
            if (std::all_of(weighted.begin(), weighted.end(), isBlack)) continue;
            image.setRgb("weighted." + layerName(s, t), mean(s, t, false));
            image.setRgb("unweighted." + layerName(s, t), mean(s, t, true));
            const std::vector<Rgb>& added = layers_[2 * indexOf(s, t)];
            for (std::size_t i = 0; i < pixels; ++i) {
                const double sum = double(added[i].r) + double(added[i].g) + double(added[i].b);
                total[i] += sum;
                if (t == 2 && s > 0) first[i] += sum;
            }
        }
    }
    std::vector<float>& share = image.channel("share.t02");
    for (std::size_t i = 0; i < pixels; ++i) {
        share[i] = total[i] > 0.0 ? float(first[i] / total[i]) : 0.0f;
    }
}

}  // namespace lacuna

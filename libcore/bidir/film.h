// Where contributions go: one iteration's picture, and the sums over iterations.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/image/image.h"

namespace lacuna {

class ThreadPool;

/// Half-open rectangle of pixels.
struct PixelRect {
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
    friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// A contribution to a pixel that its maker does not own.
struct Splat {
    std::uint32_t pixel;  ///< row-major index in the crop
    Rgb value;
};

/// Adds the lists of splats in order: chunk by chunk, each in its own order, so that sums are the
/// same to the last bit for any number of threads. Returns how many were left out
/// because their pixel's sum would not have been finite.
std::uint64_t addSplats(std::span<const std::vector<Splat>> chunks, std::span<Rgb> pixels,
                        const ThreadPool& pool);

/// Sums over iterations, in double: the mean picture and the variance of that mean, from iterations
/// as independent samples.
class Film {
  public:
    Film(int width, int height);

    /// One finished iteration: `pixels` = width * height values.
    void add(std::span<const Rgb> pixels, const ThreadPool& pool);

    int width() const { return width_; }
    int height() const { return height_; }
    std::uint64_t iterations() const { return iterations_; }

    /// Mean over iterations; black before the first.
    Image image() const;
    /// Variance of the mean per pixel and channel; zero before the second iteration.
    Image variance() const;
    struct MeanColour {
        double mean[3] = {0, 0, 0};
        double standardError[3] = {0, 0, 0};  ///< zero before the second iteration
    };
    /// Mean of the whole picture, its standard error from the spread of iterations' means.
    MeanColour meanColour() const;

  private:
    int width_, height_;
    std::uint64_t iterations_ = 0;
    std::vector<Vec3d> sum_, sumOfSquares_;
    double meanSum_[3] = {0, 0, 0}, meanSquares_[3] = {0, 0, 0};
};

/// A pair of pictures per technique (s, t), summed over iterations: --techniques.
class TechniqueFilm {
  public:
    TechniqueFilm(int width, int height, int maxDepth);

    /// "s02t03"
    static std::string layerName(int s, int t);
    /// Adds to one pixel; different pixels may be added to at the same time.
    void add(int s, int t, std::uint32_t pixel, const Rgb& weighted, const Rgb& unweighted);
    void countIteration() { ++iterations_; }
    /// Layers weighted.sSStTT and unweighted.sSStTT, of techniques that ever contributed, and the
    /// channel share.t02: what connections of the first eye vertex (t = 2, s > 0) add to the
    /// pixel's mean over the channels, as a share of it [Nabata20a fig 2]; 0 where it is black.
    void writeTo(LayeredImage& image) const;
    Image weighted(int s, int t) const { return mean(s, t, false); }
    Image unweighted(int s, int t) const { return mean(s, t, true); }
    int maxDepth() const { return maxDepth_; }

  private:
    std::size_t indexOf(int s, int t) const;
    Image mean(int s, int t, bool unweighted) const;

    int width_, height_, maxDepth_;
    std::uint64_t iterations_ = 0;
    std::vector<std::vector<Rgb>> layers_;  // [technique * 2 + unweighted]
};

}  // namespace lacuna

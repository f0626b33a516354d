// Estimates from the picture alone how far it is from its expectation: no reference exists while it
// renders. (theory.md, "The error without a reference")
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/features.h"
#include "libcore/bidir/film_sum.h"

namespace lacuna {

/// Measures pictures on a regular lattice of their pixels, so that the cost does not grow with their size. For each
/// place of the lattice it knows which pixels around show the same thing.
class ErrorMeter {
  public:
    explicit ErrorMeter(const FeatureLayers& features);

    /// Whether a tree's node of `size` iterations, whose range ends at `end`, is worth measuring.
    /// Smaller ones say nothing of a picture of so many iterations.
    static bool wants(std::uint64_t size, std::uint64_t end) { return 8 * size >= end; }

    /// Relative difference of two halves of equally many iterations: h(m). `threads` may be null.
    HalfDifference difference(const FilmSum& left, const FilmSum& right,
                              const ThreadPool* threads) const;

    /// A mean over the lattice. `unevenness` says how few places carry it: the root of the sum of
    /// the terms' squares over the terms' sum. It is 1 if a single place carries all.
    struct Mean {
        double value = 0.0;
        double unevenness = 0.0;
    };
    /// Means of the variance of the picture (absolute), and of that variance over R^2 + e^2
    /// (relative; R is the smoothed picture). Zero where the variance is not known.
    struct Squares {
        Mean absolute, relative;
    };
    Squares squares(const FilmSum& sum, const ThreadPool* threads) const;

    /// The mean over the lattice of `values`, one per pixel, each over R^2 + e^2. R is the mean of
    /// the picture's three channels, smoothed. `threads` may be null.
    double overSquare(const FilmSum& sum, std::span<const float> values,
                      const ThreadPool* threads) const;

    std::size_t places() const { return places_.size(); }

  private:
    struct Place {
        std::uint32_t pixel;
        std::uint64_t alike;  ///< one bit per pixel of the window, row by row: shows the same
    };
    Vec3d smoothed(std::span<const Rgb> left, std::span<const Rgb> right, const Place& place) const;
    template <class Term>
    Mean mean(const ThreadPool* threads, const Term& term) const;

    int width_;
    std::vector<Place> places_;
};

/// One of the measures of error_metrics.h.
struct Measured {
    double error = 0.0;
    /// Why `error` is no promise yet. If empty, the true error is at most a tenth above `error` in 95 of 100 pictures
    /// (theory.md, "The error without a reference").
    std::string doubt;
};

struct ErrorEstimate {
    Measured mape, relmse, rmse;

    /// The measure of this name: "mape", "relmse" or "rmse". Null for other names.
    const Measured* find(std::string_view measure) const;
};

/// Estimates the errors of the mean of all iterations of `sum`, whose halves `meter` has compared.
ErrorEstimate estimateError(const FilmSum& sum, const ErrorMeter& meter, const ThreadPool* threads);

/// Whether errors are estimated after so many iterations: 4, 5, 6, 7 times a power of two. So a
/// render that stops by its error stops at the same iteration on every machine.
bool isMeasured(std::uint64_t iterations);

}  // namespace lacuna

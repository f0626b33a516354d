// How far a picture is from its expectation, by the picture alone: nobody has the reference while
// it renders. (theory.md, "The error without a reference")
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/features.h"
#include "libcore/bidir/film_sum.h"

namespace lacuna {

/// Looks at pictures on a regular lattice of their pixels, so that its cost does not grow with them,
/// and knows of each which pixels around it show the same thing.
class ErrorMeter {
  public:
    explicit ErrorMeter(const FeatureLayers& features);

    /// Of the nodes of a tree whose range of iterations ends at `end`, those of `size` iterations
    /// that are worth measuring: smaller ones say nothing of a picture of so many.
    static bool wants(std::uint64_t size, std::uint64_t end) { return 8 * size >= end; }

    /// What two halves of equally many iterations differ by. `threads` may be null.
    HalfDifference difference(const FilmSum& left, const FilmSum& right,
                              const ThreadPool* threads) const;

    /// A mean over the lattice, and how few places carry it: the share of the whole that the sum's
    /// own terms would scatter by, root of the sum of their squares over their sum.
    struct Mean {
        double value = 0.0;
        double unevenness = 0.0;
    };
    /// Of the variance of the mean, and of it over R^2 + e^2 (R smoothed).
    struct Squares {
        Mean absolute, relative;
    };
    Squares squares(const FilmSum& sum, const ThreadPool* threads) const;

    /// The mean over the lattice of `values`, one per pixel, over R^2 + e^2 (R: the mean of the
    /// picture's channels, smoothed). `threads` may be null.
    double overSquare(const FilmSum& sum, std::span<const float> values,
                      const ThreadPool* threads) const;

    std::size_t places() const { return places_.size(); }

  private:
    struct Place {
        std::uint32_t pixel;
        std::uint64_t alike;  ///< a bit per pixel of the window, row by row
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
    /// Why no promise can be made of it yet; empty: the error is at most a tenth above `error` in 95
    /// of 100 pictures (theory.md, "The error without a reference").
    std::string doubt;
};

struct ErrorEstimate {
    Measured mape, relmse, rmse;

    /// By name; null for another one.
    const Measured* find(std::string_view measure) const;
};

/// Of the mean of all iterations of `sum`, whose halves were compared by `meter`.
ErrorEstimate estimateError(const FilmSum& sum, const ErrorMeter& meter, const ThreadPool* threads);

/// Whether errors are looked at after so many iterations: 4, 5, 6, 7 times a power of two. A render
/// that stops by its error then stops where it would on any other machine.
bool isMeasured(std::uint64_t iterations);

}  // namespace lacuna

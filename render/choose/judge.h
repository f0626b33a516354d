// How far pictures of the same scene by different methods are from what they all aim at, when
// nobody knows it: each has noise of its own, so that the distance of two says what both have.
// (theory.md, "auto")
#pragma once

#include <span>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

/// A method's small picture, from two independent halves of equally many iterations.
struct HalfPictures {
    std::vector<Rgb> first, second;  ///< row by row
};

/// The mape of the mean of both halves, by picture; all of `width` pixels a row, at least one.
///
/// |I_i - I_j| over what all of them show, smoothed, is d_ij. Errors that are rare and large add up,
/// d_ij = s_i + s_j, solved for s by least squares; of many small ones d_ij is less. Those a
/// picture's own halves tell, which differ by what it has seen; light that it never met shows in the
/// distance to the others alone. So s_i is the larger of both.
std::vector<double> errorsOf(std::span<const HalfPictures> pictures, int width);

/// The mape of a picture that lacks `part`, of its channels: what no other row brings.
double errorWithout(std::span<const Rgb> part, const HalfPictures& picture, int width);

/// What a trial found of a row.
struct Verdict {
    double error = 0.0;  ///< mape of its small picture
    double loss = 0.0;   ///< its squared error at the end of the render
};

/// The row to take: the usual one where none is clearly better. Where trials met hardly any light,
/// rows that met the least look the best, so that what counts as clear grows with the usual row's
/// error; from 1 on nothing takes its place.
std::size_t rowToTake(std::span<const Verdict> verdicts, std::size_t usual);

}  // namespace lacuna

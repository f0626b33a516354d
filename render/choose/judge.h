// Errors of pictures of the same scene by different methods, without a reference. The pictures have
// independent noise, so that the distance of two pictures tells the sum of their errors.
// (theory.md, "auto")
#pragma once

#include <span>
#include <vector>

#include "libcore/base/vec.h"

namespace lacuna {

/// A method's small picture, from two independent halves of equally many iterations.
struct HalfPictures {
    std::vector<Rgb> first, second;  ///< row-major
};

/// The mape of the mean of both halves, by picture. All pictures have rows of `width` pixels; there
/// must be at least one picture.
///
/// d_ij is the mean of |I_i - I_j| relative to the smoothed mean of all pictures. Rare and large
/// errors add up: d_ij = s_i + s_j, which is solved for s by least squares. For many small errors,
/// d_ij is less than the sum; these show in the difference of a picture's own halves. Light that a
/// picture never met shows only in its distance to the others. Therefore s_i is the larger of both
/// estimates.
std::vector<double> errorsOf(std::span<const HalfPictures> pictures, int width);

/// The mape of a picture that lacks `part`, light that no other row finds.
double errorWithout(std::span<const Rgb> part, const HalfPictures& picture, int width);

/// The result of a row's trial.
struct Verdict {
    double error = 0.0;  ///< mape of its small picture
    double loss = 0.0;   ///< its squared error at the end of the render
};

/// Index of the row to take: the usual one if none is clearly better. If trials met hardly any
/// light, rows that met the least look best. Therefore the required difference grows with the usual
/// row's error; from an error of 1 on, nothing replaces it.
std::size_t rowToTake(std::span<const Verdict> verdicts, std::size_t usual);

}  // namespace lacuna

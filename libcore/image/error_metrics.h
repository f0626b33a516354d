// Errors of an image against a reference (render/README.md, "lacuna-compare").
#pragma once

#include <cstddef>
#include <string>

#include "libcore/image/image.h"

namespace lacuna {

/// Means over all pixels and the three channels, e = 0.01 mean R:
///   mae  = mean |I - R|              rmse   = sqrt(mean (I - R)^2)      (radiance)
///   mape = mean |I - R| / (R + e)    relmse = mean (I - R)^2 / (R^2 + e^2)
/// For a black reference, mape and relmse are 0 if I = R everywhere, else infinite.
struct ErrorMeasures {
    double mae = 0.0;
    double rmse = 0.0;
    double mape = 0.0;
    double relmse = 0.0;
    std::size_t pixels = 0;
};

/// Throws InputError, which names both pictures, unless they have the same size.
void requireSameSize(const std::string& name, ImageSize size, const std::string& referenceName,
                     ImageSize referenceSize);

/// A validated reference, with the values that every comparison against it needs.
class ErrorReference {
  public:
    /// `name` is what messages call the reference. Throws InputError if it is empty, holds a
    /// non-finite value, or one so negative that R + e is not positive.
    explicit ErrorReference(Image reference, std::string name = "reference");

    /// The errors of `image`, which messages call `name`. One thread sums in double and in a fixed
    /// order, so that the result is the same on any machine with IEEE doubles. Throws InputError if
    /// the sizes differ or `image` has a non-finite value.
    ErrorMeasures compare(const Image& image, const std::string& name = "image") const;

    /// |I - R| / (R + e), mean of the three channels, at pixel (x, y); infinite where the whole
    /// reference is black and I is not.
    double relativeError(const Image& image, int x, int y) const;

    /// Throws InputError like `compare`.
    void requireComparable(const Image& image, const std::string& name) const;

    const Image& image() const { return reference_; }
    /// e = 0.01 mean R.
    double epsilon() const { return epsilon_; }

  private:
    Image reference_;
    std::string name_;
    double epsilon_ = 0.0;
};

}  // namespace lacuna

#include "libcore/image/error_metrics.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "libcore/base/error.h"

namespace lacuna {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::array<double, 3> channels(const Rgb& c) {
    return {c.r, c.g, c.b};
}

std::string place(std::size_t index, int width, int channel) {
    const std::size_t w = std::size_t(width);
    return std::string(1, "RGB"[channel]) + " of pixel (" + std::to_string(index % w) + ", " +
           std::to_string(index / w) + ")";
}

void requireFinite(const Image& image, const std::string& name) {
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const auto c = channels(image.pixels[i]);
        for (int k = 0; k < 3; ++k) {
            if (std::isfinite(c[k])) continue;
            throw InputError(name + ": expected finite pixels, found " + std::to_string(c[k]) +
                             " in " + place(i, image.width, k) + "; find out where it comes from");
        }
    }
}

/// A sum of row sums, whose rounding error grows with width + height and not with their product.
class RowSum {
  public:
    void add(double v) { row_ += v; }
    void endRow() { total_ += std::exchange(row_, 0.0); }
    double total() const { return total_; }

  private:
    double row_ = 0.0;
    double total_ = 0.0;
};

/// One term of mape. For a black reference e = 0 and R = 0.
double relative(double i, double r, double e) {
    const double d = std::abs(i - r);
    return d == 0.0 ? 0.0 : (r + e == 0.0 ? kInfinity : d / (r + e));
}

}  // namespace

void requireSameSize(const std::string& name, ImageSize size, const std::string& referenceName,
                     ImageSize referenceSize) {
    if (size == referenceSize) return;
    throw InputError(name + ": expected " + std::to_string(referenceSize.width) + " x " +
                     std::to_string(referenceSize.height) + " pixels as in " + referenceName +
                     ", found " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                     "; render both at one size");
}

ErrorReference::ErrorReference(Image reference, std::string name)
    : reference_(std::move(reference)), name_(std::move(name)) {
    if (reference_.empty()) throw InputError(name_ + ": expected a reference, found no pixels");
    requireFinite(reference_, name_);
    RowSum sum;
    bool black = true;
    for (int y = 0; y < reference_.height; ++y, sum.endRow()) {
        for (int x = 0; x < reference_.width; ++x) {
            const Rgb& c = reference_.at(x, y);
            black = black && isBlack(c);
            for (const double r : channels(c)) sum.add(r);
        }
    }
    epsilon_ = 0.01 * sum.total() / (3.0 * double(reference_.pixels.size()));
    if (black) return;
    for (std::size_t i = 0; i < reference_.pixels.size(); ++i) {
        const auto c = channels(reference_.pixels[i]);
        for (int k = 0; k < 3; ++k) {
            if (c[k] + epsilon_ > 0.0) continue;
            throw InputError(name_ + ": expected radiance above -e = " + std::to_string(-epsilon_) +
                             ", found " + std::to_string(c[k]) + " in " +
                             place(i, reference_.width, k) +
                             "; the measures are not defined there");
        }
    }
}

void ErrorReference::requireComparable(const Image& image, const std::string& name) const {
    requireSameSize(name, image.size(), name_, reference_.size());
    requireFinite(image, name);
}

ErrorMeasures ErrorReference::compare(const Image& image, const std::string& name) const {
    requireComparable(image, name);
    const double e = epsilon_;
    RowSum absolute, squared, relativeAbsolute, relativeSquared;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto i = channels(image.at(x, y)), r = channels(reference_.at(x, y));
            for (int k = 0; k < 3; ++k) {
                const double d = i[k] - r[k];
                absolute.add(std::abs(d));
                squared.add(d * d);
                relativeAbsolute.add(relative(i[k], r[k], e));
                const double scale = r[k] * r[k] + e * e;
                relativeSquared.add(d == 0.0 ? 0.0 : scale == 0.0 ? kInfinity : d * d / scale);
            }
        }
        for (RowSum* sum : {&absolute, &squared, &relativeAbsolute, &relativeSquared}) {
            sum->endRow();
        }
    }
    const double n = 3.0 * double(image.pixels.size());
    return {absolute.total() / n, std::sqrt(squared.total() / n), relativeAbsolute.total() / n,
            relativeSquared.total() / n, image.pixels.size()};
}

double ErrorReference::relativeError(const Image& image, int x, int y) const {
    const auto i = channels(image.at(x, y)), r = channels(reference_.at(x, y));
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) sum += relative(i[k], r[k], epsilon_);
    return sum / 3.0;
}

}  // namespace lacuna

// (theory.md, "Lights", "Skies")
#include "libcore/scene/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "libcore/base/error.h"
#include "libcore/base/sampling.h"

namespace lacuna {

namespace {
/// Relative margin for rounding: a cell must exceed the mean by more than this.
constexpr double kRounding = 1e-5;
}  // namespace

Environment::Environment(Image image, double scale, double rotationDegrees, const std::string& file)
    : width_(image.width),
      height_(image.height),
      image_(std::move(image.pixels)),
      turn_(float(rotationDegrees / 360.0 - std::floor(rotationDegrees / 360.0))) {
    if (width_ < 1 || height_ < 1) {
        throw InputError(file + ": expected an environment map, found an empty image");
    }
    for (std::size_t i = 0; i < image_.size(); ++i) {
        const Rgb c = image_[i] *= float(scale);
        if (!isFinite(c) || c.r < 0.0f || c.g < 0.0f || c.b < 0.0f) {
            throw InputError(
                file + ": expected radiance that is finite and not negative, found " +
                std::to_string(c.r) + " " + std::to_string(c.g) + " " + std::to_string(c.b) +
                " at pixel " + std::to_string(i % std::size_t(width_)) + "," +
                std::to_string(i / std::size_t(width_)) + ": repair the image or its scale");
        }
    }

    const auto edge = [&](double y) {
        return std::cos(std::numbers::pi * std::clamp(y - 0.5, 0.0, double(height_)) / height_);
    };
    for (int y = 0; y <= height_; ++y) {
        const double top = edge(y), bottom = edge(y + 1);
        bands_.push_back({top, bottom, 2.0 * std::numbers::pi / width_ * (top - bottom)});
    }

    std::vector<double> weights;
    weights.reserve(bands_.size() * std::size_t(width_));
    double sum[3] = {0, 0, 0};
    for (int y = 0; y <= height_; ++y) {
        const double solidAngle = bands_[std::size_t(y)].solidAngle;
        for (int x = 0; x < width_; ++x) {
            const Corners c = cornersOf(x, y);
            const Rgb radiance = c.leftAbove * 0.25f + c.rightAbove * 0.25f + c.leftBelow * 0.25f +
                                 c.rightBelow * 0.25f;
            weights.push_back(double(mean(radiance)) * solidAngle);
            sum[0] += double(radiance.r) * solidAngle;
            sum[1] += double(radiance.g) * solidAngle;
            sum[2] += double(radiance.b) * solidAngle;
        }
    }
    integral_ = {float(sum[0]), float(sum[1]), float(sum[2])};
    whole_ = tableOf(weights);
    if (black()) return;
    even_ = image_.size() == 1;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        weights[i] = std::max(0.0, whole_.cells.pmf(i) - evenly(int(i / std::size_t(width_))));
    }
    above_ = tableOf(weights);
}
Environment::Table Environment::tableOf(std::span<const double> weights) const {
    Table table{DiscreteDistribution(weights), {}};
    for (std::size_t y = 0; y <= bands_.size(); ++y) {
        table.rows.push_back(table.cells.before(y * std::size_t(width_)));
    }
    return table;
}
double Environment::evenly(int row) const {
    return (1.0 + kRounding) * bands_[std::size_t(row)].solidAngle / (4.0 * std::numbers::pi);
}

Environment::Place Environment::placeOf(Vec3 d) const {
    const float turns = 0.5f + turnsOf(d.x, -d.z) - turn_;
    const float u = turns - std::floor(turns);
    const float v = 2.0f * turnsOf(std::sqrt(d.x * d.x + d.z * d.z), d.y);
    const float x = u * float(width_) - 0.5f, y = v * float(height_) - 0.5f;
    const int left = int(std::floor(x)), above = int(std::floor(y));
    return {(left + width_) % width_, std::clamp(above + 1, 0, height_), x - float(left),
            y - float(above)};
}

Environment::Corners Environment::cornersOf(int x, int y) const {
    const int right = x + 1 < width_ ? x + 1 : 0;
    const int above = std::max(y - 1, 0), below = std::min(y, height_ - 1);
    return {texel(x, above), texel(right, above), texel(x, below), texel(right, below)};
}

Rgb Environment::radianceAt(const Place& p) const {
    const Corners c = cornersOf(p.x, p.y);
    return c.leftAbove * ((1 - p.right) * (1 - p.bottom)) +
           c.rightAbove * (p.right * (1 - p.bottom)) + c.leftBelow * ((1 - p.right) * p.bottom) +
           c.rightBelow * (p.right * p.bottom);
}

/// Share of the row, by solid angle, that is above `direction`. The direction is normalised in
/// double: at the poles, the rounding of its length is a considerable part of a row.
double Environment::shareBelow(int y, Vec3 direction) const {
    const Vec3d d(direction);
    const LatitudeBand& band = bands_[std::size_t(y)];
    return std::clamp((band.top - d.y / length(d)) / (band.top - band.bottom), 0.0, 1.0);
}

namespace {

/// A density that is linear on [0, 1].
struct Linear {
    double begin, end;  ///< proportional to the density at 0 and 1; not both 0

    double sample(double u) const {
        const double root = std::sqrt(begin * begin + u * (end * end - begin * begin));
        const double sum = begin + root;
        return sum > 0.0 ? std::min(u * (begin + end) / sum, 1.0) : u;
    }
    /// The inverse of sample().
    double cdf(double x) const {
        const double sum = begin + end;
        return sum > 0.0 ? x * (2.0 * begin + x * (end - begin)) / sum : x;
    }
};

/// A bilinear density in a cell: the marginal density downwards, and the conditional density to the
/// right.
struct Bilinear {
    double leftAbove, rightAbove, leftBelow, rightBelow;

    Linear down() const { return {leftAbove + rightAbove, leftBelow + rightBelow}; }
    Linear across(double below) const {
        return {leftAbove + (leftBelow - leftAbove) * below,
                rightAbove + (rightBelow - rightAbove) * below};
    }
};

/// The direction with this cosine to +Y and this longitude in turns, from -Z towards +X.
Vec3 directionAt(double cosine, float turns) {
    const auto sine = float(std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine))));
    const SineCosine longitude = sineCosineOfTurns(turns);
    return {sine * longitude.sine, float(cosine), -sine * longitude.cosine};
}

Bilinear bilinear(const auto& corners) {
    return {double(mean(corners.leftAbove)), double(mean(corners.rightAbove)),
            double(mean(corners.leftBelow)), double(mean(corners.rightBelow))};
}

}  // namespace

Environment::Sample Environment::sample(double uCell, float u1, float u2, SkyPart part) const {
    return inCell(table(part).cells.sample(uCell), u1, u2);
}

Environment::Sample Environment::sampleSquare(double across, double down, SkyPart part) const {
    if (even_) {
        return {directionAt(1.0 - 2.0 * down, float(across) + turn_), {image_[0], kEvenPdfW}};
    }
    const auto& [cells, rows] = table(part);
    // The last row that begins at or below `down`: it has a positive probability.
    const auto next = std::upper_bound(rows.begin() + 1, rows.end() - 1, down);
    const double begin = next[-1], end = *next;
    // Rounding must not lead to the next row.
    const double u = std::min(begin + across * (end - begin), std::nextafter(end, begin));
    const DiscreteDistribution::Pick cell = cells.sample(u);
    return inCell(cell, cell.remapped(), (down - begin) / (end - begin));
}

double Environment::aboveMeanAt(const Place& p) const {
    const std::size_t cell = std::size_t(p.y) * std::size_t(width_) + std::size_t(p.x);
    const double whole = whole_.cells.pmf(cell);
    // The table above_ has the same value but would need another memory access.
    return whole > 0.0 ? std::max(0.0, 1.0 - evenly(p.y) / whole) / contrast() : 0.0;
}

SquarePoint Environment::squareOf(Vec3 direction) const {
    const Place p = placeOf(direction);
    const auto& [cells, rows] = whole_;
    const auto row = std::size_t(p.y), cell = row * std::size_t(width_) + std::size_t(p.x);
    const double begin = rows[row], end = rows[row + 1];
    const Bilinear density = bilinear(cornersOf(p.x, p.y));
    const double below = shareBelow(p.y, direction);
    const auto share = [](double part) { return std::clamp(part, 0.0, 1.0); };
    const double down = share(density.down().cdf(below));
    const double across = cells.before(cell) - begin +
                          share(density.across(below).cdf(double(p.right))) * cells.pmf(cell);
    return {end > begin ? share(across / (end - begin)) : 0.0, begin + down * (end - begin)};
}

SkySides Environment::sides(SkyPart part) const {
    SkySides::Sum sum;
    // Cells of a coarse sky are large: each is sampled at several points, at most five degrees
    // apart.
    const int across = 1 + 72 / width_, down = 1 + 36 / height_;
    for (std::size_t i = 0; i < bands_.size() * std::size_t(width_); ++i) {
        const double share = table(part).cells.pmf(i) / double(across * down);
        if (!(share > 0.0)) continue;
        const LatitudeBand& band = bands_[i / std::size_t(width_)];
        const auto x = double(i % std::size_t(width_)) + 0.5;
        for (int j = 0; j < down; ++j) {
            const double cosine = band.top + (band.bottom - band.top) * (j + 0.5) / down;
            for (int k = 0; k < across; ++k) {
                const double turns = (x + (k + 0.5) / across) / double(width_);
                sum.add(directionAt(cosine, float(turns) - 0.5f + turn_), share);
            }
        }
    }
    return SkySides(sum);
}

Environment::Sample Environment::inCell(const DiscreteDistribution::Pick& pick, double u1,
                                        double u2) const {
    const int x = int(pick.index) % width_, y = int(pick.index) / width_;
    const LatitudeBand& band = bands_[std::size_t(y)];
    const Bilinear density = bilinear(cornersOf(x, y));
    const double below = density.down().sample(u2);
    const double right = density.across(below).sample(u1);
    const double cosine = band.top + (band.bottom - band.top) * below;
    const Vec3 direction =
        directionAt(cosine, float((double(x) + 0.5 + right) / double(width_)) - 0.5f + turn_);
    // Rounding may lead to the next cell; the density is that of the resulting direction.
    return {direction, seen(direction)};
}

float Environment::pdfWAt(const Place& p, Vec3 direction) const {
    if (black()) return 0.0f;
    const Bilinear density = bilinear(cornersOf(p.x, p.y));
    const Linear across = density.across(shareBelow(p.y, direction));
    const Linear down = density.down();
    const double all = 0.25 * (down.begin + down.end);
    if (!(all > 0.0)) return 0.0f;
    const double here = across.begin + (across.end - across.begin) * double(p.right);
    const double pmf = whole_.cells.pmf(std::size_t(p.y) * std::size_t(width_) + std::size_t(p.x));
    return float(pmf * here / (all * bands_[std::size_t(p.y)].solidAngle));
}

}  // namespace lacuna

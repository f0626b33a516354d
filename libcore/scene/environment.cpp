#include "libcore/scene/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "libcore/base/error.h"
#include "libcore/base/sampling.h"

namespace lacuna {

Environment::Environment(const Image& image, double scale, double rotationDegrees,
                         const std::string& file)
    : width_(image.width),
      height_(image.height),
      image_(image.pixels.begin(), image.pixels.end()),
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

    for (int y = 0; y < height_; ++y) {
        const double top = std::cos(std::numbers::pi * y / height_);
        const double bottom = std::cos(std::numbers::pi * (y + 1) / height_);
        rows_.push_back({top, bottom, 2.0 * std::numbers::pi / width_ * (top - bottom)});
    }

    // A texel's interpolated radiance reaches into all eight neighbours: the tent's integrals over
    // one texel are 1/8, 6/8, 1/8 along each axis.
    std::vector<double> weights(image_.size());
    double sum[3] = {0, 0, 0};
    for (int y = 0; y < height_; ++y) {
        const double solidAngle = rows_[std::size_t(y)].solidAngle;
        for (int x = 0; x < width_; ++x) {
            Rgb meanRadiance{};
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    const float w = (dx ? 0.125f : 0.75f) * (dy ? 0.125f : 0.75f);
                    meanRadiance += texel((x + dx + width_) % width_,
                                          std::min(std::max(y + dy, 0), height_ - 1)) *
                                    w;
                }
            }
            weights[std::size_t(y) * width_ + x] = double(mean(meanRadiance)) * solidAngle;
            sum[0] += meanRadiance.r * solidAngle;
            sum[1] += meanRadiance.g * solidAngle;
            sum[2] += meanRadiance.b * solidAngle;
        }
    }
    integral_ = {float(sum[0]), float(sum[1]), float(sum[2])};
    texels_ = DiscreteDistribution(weights);
}

Vec2 Environment::uvOf(Vec3 d) const {
    const float u = 0.5f + turnsOf(d.x, -d.z) - turn_;
    const float v = 2.0f * turnsOf(std::sqrt(d.x * d.x + d.z * d.z), d.y);
    return {u - std::floor(u), v};
}

Rgb Environment::radianceAt(Vec2 uv) const {
    const float x = uv.x * float(width_) - 0.5f, y = uv.y * float(height_) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const float fx = x - float(x0), fy = y - float(y0);
    const auto row = [&](int r) { return std::min(std::max(r, 0), height_ - 1); };
    const auto column = [&](int c) { return (c + width_) % width_; };
    return texel(column(x0), row(y0)) * ((1 - fx) * (1 - fy)) +
           texel(column(x0 + 1), row(y0)) * (fx * (1 - fy)) +
           texel(column(x0), row(y0 + 1)) * ((1 - fx) * fy) +
           texel(column(x0 + 1), row(y0 + 1)) * (fx * fy);
}

Environment::Sample Environment::sample(double uTexel, float u1, float u2) const {
    return inTexel(texels_.sample(uTexel), u1, u2);
}

Environment::Sample Environment::sampleSquare(double across, double down) const {
    const auto width = std::size_t(width_);
    const std::size_t row = texels_.sample(down).index / width;
    const double begin = texels_.before(row * width), end = texels_.before((row + 1) * width);
    // Rounding must not lead into the next row.
    const double u = std::min(begin + across * (end - begin), std::nextafter(end, begin));
    const DiscreteDistribution::Pick texel = texels_.sample(u);
    return inTexel(texel, float(texel.remapped()), float((down - begin) / (end - begin)));
}

SquarePoint Environment::squareOf(Vec3 direction) const {
    const Vec2 uv = uvOf(direction);
    const auto width = std::size_t(width_);
    const double column = double(uv.x) * width_;
    const auto x = std::min(std::size_t(column), width - 1);
    const auto y = std::min(std::size_t(uv.y * float(height_)), std::size_t(height_ - 1));
    const Row& row = rows_[y];
    const double begin = texels_.before(y * width), end = texels_.before((y + 1) * width);
    const double rest = texels_.before(y * width + x) - begin;
    const auto share = [](double part) { return std::clamp(part, 0.0, 1.0); };
    const double down = share((row.top - double(direction.y)) / (row.top - row.bottom));
    const double across = rest + share(column - double(x)) * texels_.pmf(y * width + x);
    return {end > begin ? share(across / (end - begin)) : 0.0, begin + down * (end - begin)};
}

/// Uniform in it.
Environment::Sample Environment::inTexel(const DiscreteDistribution::Pick& pick, float u1,
                                         float u2) const {
    const int x = int(pick.index) % width_, y = int(pick.index) / width_;
    const Row& row = rows_[std::size_t(y)];
    // Uniform in solid angle inside the texel: uniform in longitude and in the cosine.
    const double cosine = row.top + (row.bottom - row.top) * u2;
    const auto sine = float(std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine))));
    const SineCosine longitude = sineCosineOfTurns((float(x) + u1) / float(width_) - 0.5f + turn_);
    const Vec3 direction{sine * longitude.sine, float(cosine), -sine * longitude.cosine};
    // Rounding may lead into the next texel: the density is the one that is found there.
    return {direction, pdfW(direction)};
}

float Environment::pdfWAt(Vec2 uv) const {
    if (black()) return 0.0f;
    const int x = std::min(int(uv.x * float(width_)), width_ - 1);
    const int y = std::min(int(uv.y * float(height_)), height_ - 1);
    return float(texels_.pmf(std::size_t(y) * width_ + x) / rows_[std::size_t(y)].solidAngle);
}

}  // namespace lacuna

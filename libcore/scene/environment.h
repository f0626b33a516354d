// Latitude-longitude environment map: radiance by direction, and directions by radiance.
#pragma once

#include "libcore/base/discrete.h"
#include "libcore/base/square_density.h"
#include "libcore/base/vec.h"
#include "libcore/image/image.h"

namespace lacuna {

/// Centre of the image -Z, right half +X, top row +Y (theory.md, "Lights"). Radiance is the
/// bilinear interpolation of the texels (periodic in longitude); the density is constant per texel
/// and positive wherever that interpolation is.
class Environment {
  public:
    /// `rotationDegrees` turns the map about +Y (positive: from -Z towards +X). Throws InputError
    /// for an empty image or negative or non-finite texels, naming `file`.
    Environment(const Image& image, double scale, double rotationDegrees, const std::string& file);

    Rgb radiance(Vec3 direction) const { return radianceAt(uvOf(direction)); }
    /// Density of `sample` at `direction`, per solid angle; 0 for a black map.
    float pdfW(Vec3 direction) const { return pdfWAt(uvOf(direction)); }
    /// Both.
    struct Seen {
        Rgb radiance;
        float pdfW;
    };
    Seen seen(Vec3 direction) const {
        const Vec2 uv = uvOf(direction);
        return {radianceAt(uv), pdfWAt(uv)};
    }

    struct Sample {
        Vec3 direction;  ///< unit, from the scene towards the sky
        float pdfW;
    };
    /// Not to be called for a black map.
    Sample sample(double uTexel, float u1, float u2) const;
    /// The same density from a point of the square: points that are even there are even in the sky.
    Sample sampleSquare(double across, double down) const;
    /// The point of the square that gives `direction`: {across, down}. Not for a black map.
    SquarePoint squareOf(Vec3 direction) const;

    bool black() const { return texels_.empty(); }
    /// Integral of the radiance over all directions (by texel means).
    Rgb integral() const { return integral_; }

  private:
    Vec2 uvOf(Vec3 direction) const;
    Rgb radianceAt(Vec2 uv) const;
    float pdfWAt(Vec2 uv) const;
    Sample inTexel(const DiscreteDistribution::Pick& texel, float u1, float u2) const;
    const Rgb& texel(int x, int y) const { return image_[std::size_t(y) * width_ + x]; }

    int width_, height_;
    std::vector<Rgb> image_;
    struct Row {
        double top, bottom;  ///< cosines to +Y of its edges
        double solidAngle;   ///< of a texel: exact, so that densities integrate to one
    };
    std::vector<Row> rows_;
    DiscreteDistribution texels_;
    Rgb integral_;
    float turn_;  ///< rotation as a fraction of a whole turn
};

}  // namespace lacuna

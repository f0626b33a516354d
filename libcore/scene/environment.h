// Latitude-longitude environment map: radiance by direction, and directions sampled by radiance.
#pragma once

#include "libcore/base/discrete.h"
#include "libcore/base/sampling.h"
#include "libcore/base/square_density.h"
#include "libcore/base/vec.h"
#include "libcore/image/image.h"
#include "libcore/scene/sky_sides.h"

namespace lacuna {

/// The image's centre is -Z, its right half +X, its top row +Y (theory.md, "Lights"). Radiance is
/// the bilinear interpolation of the texels (periodic in longitude). The density is proportional to
/// the bilinear interpolation of their means over the channels. The two differ in one respect:
/// between two rows of texels, radiance is linear in the angle, and the density in its cosine.
class Environment {
  public:
    /// `rotationDegrees` turns the map about +Y (positive: from -Z towards +X). Throws InputError,
    /// which names `file`, for an empty image or negative or non-finite texels.
    Environment(Image image, double scale, double rotationDegrees, const std::string& file);

    Rgb radiance(Vec3 direction) const {
        return even_ ? image_[0] : radianceAt(placeOf(direction));
    }
    /// Density of `sample` at `direction`, per solid angle; 0 for a black map.
    float pdfW(Vec3 direction) const {
        return even_ ? kEvenPdfW : pdfWAt(placeOf(direction), direction);
    }
    /// Radiance and density.
    struct Seen {
        Rgb radiance;
        float pdfW;
    };
    Seen seen(Vec3 direction) const {
        if (even_) return {image_[0], kEvenPdfW};
        const Place place = placeOf(direction);
        return {radianceAt(place), pdfWAt(place, direction)};
    }

    struct Sample {
        Vec3 direction;  ///< unit, from the scene towards the sky
        Seen seen;       ///< in that direction
    };
    /// The part of the sky that is sampled: the whole radiance, or the part of each cell above the
    /// mean [Karlik19].
    enum class SkyPart { Whole, AboveMean };
    /// Samples a direction. The reported density is that of SkyPart::Whole, whatever the part. Must not be called for a
    /// black map or an empty part.
    Sample sample(double uTexel, float u1, float u2, SkyPart part = SkyPart::Whole) const;
    /// Samples the same density from a point of the unit square. The map keeps low-discrepancy
    /// points even.
    Sample sampleSquare(double across, double down, SkyPart part = SkyPart::Whole) const;
    /// The inverse: the point {across, down} of the square that is mapped to `direction`. Must not
    /// be called for a black map.
    SquarePoint squareOf(Vec3 direction) const;

    bool black() const { return whole_.cells.empty(); }
    /// Integral over all directions of the radiance as the density interpolates it.
    Rgb integral() const { return integral_; }
    /// Share of the light above the mean: 0 for a constant sky, near 1 if a small sun has all the light.
    double contrast() const { return above_.cells.total(); }
    /// Irradiance of surfaces from the part, by side. Must not be called for an empty part.
    SkySides sides(SkyPart part) const;
    /// Density of sampling SkyPart::AboveMean over that of SkyPart::Whole; 0 if there is no contrast.
    double aboveMean(Vec3 direction) const {
        return above_.cells.empty() ? 0.0 : aboveMeanAt(placeOf(direction));
    }

  private:
    static constexpr float kEvenPdfW = 0.25f / kPi;  ///< of a constant sky

    // A cell lies between the centres of four texels: those above are in row y - 1, those below in
    // row y, 0 <= y <= height. The first and the last row of cells have half the height, and there
    // both rows are the same.
    struct Place {
        int x, y;             ///< cell; x is the column of its left texels
        float right, bottom;  ///< weights of the texels on these sides
    };
    Place placeOf(Vec3 direction) const;
    struct Corners {
        const Rgb &leftAbove, &rightAbove, &leftBelow, &rightBelow;
    };
    Corners cornersOf(int x, int y) const;
    Rgb radianceAt(const Place& place) const;
    float pdfWAt(const Place& place, Vec3 direction) const;
    double shareBelow(int y, Vec3 direction) const;
    Sample inCell(const DiscreteDistribution::Pick& cell, double u1, double u2) const;
    double aboveMeanAt(const Place& place) const;
    struct Table {
        DiscreteDistribution cells;
        /// Probability of all cells before each row, and 1 at the end. Reading it from the cells' table would need
        /// distant memory accesses.
        std::vector<double> rows;
    };
    const Table& table(SkyPart part) const { return part == SkyPart::Whole ? whole_ : above_; }
    Table tableOf(std::span<const double> weights) const;
    /// Probability of a cell of this row in a constant sky, plus a margin for rounding. Only the
    /// excess over it counts as above the mean.
    double evenly(int row) const;
    const Rgb& texel(int x, int y) const { return image_[std::size_t(y) * width_ + x]; }

    int width_, height_;
    std::vector<Rgb> image_;
    struct LatitudeBand {
        double top, bottom;  ///< cosines of its edges to +Y
        double solidAngle;   ///< of one cell, exact, so that densities integrate to one
    };
    std::vector<LatitudeBand> bands_;  // by row of cells
    Table whole_;
    Table above_;  ///< by the part above the mean; the total is its share
    Rgb integral_;
    bool even_ = false;  ///< constant sky: one texel that is not black
    float turn_;         ///< rotation in whole turns
};

}  // namespace lacuna

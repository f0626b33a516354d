// Latitude-longitude environment map: radiance by direction, and directions by radiance.
#pragma once

#include "libcore/base/discrete.h"
#include "libcore/base/sampling.h"
#include "libcore/base/square_density.h"
#include "libcore/base/vec.h"
#include "libcore/image/image.h"
#include "libcore/scene/sky_sides.h"

namespace lacuna {

/// Centre of the image -Z, right half +X, top row +Y (theory.md, "Lights"). Radiance is the
/// bilinear interpolation of the texels (periodic in longitude), and so is the density, of their
/// mean over the channels: up to the share of a row that is between its rows of texels, which is
/// that of the angle there and that of its cosine here.
class Environment {
  public:
    /// `rotationDegrees` turns the map about +Y (positive: from -Z towards +X). Throws InputError
    /// for an empty image or negative or non-finite texels, naming `file`.
    Environment(const Image& image, double scale, double rotationDegrees, const std::string& file);

    Rgb radiance(Vec3 direction) const {
        return even_ ? image_[0] : radianceAt(placeOf(direction));
    }
    /// Density of `sample` at `direction`, per solid angle; 0 for a black map.
    float pdfW(Vec3 direction) const {
        return even_ ? kEvenPdfW : pdfWAt(placeOf(direction), direction);
    }
    /// Both.
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
        Seen seen;       ///< there
    };
    /// What is drawn: the whole radiance, or what of each cell is above the mean [Karlik19].
    enum class Part { Whole, AboveMean };
    /// The density is that of the whole, whatever is drawn. Not to be called for a black map, nor for a part
    /// that has nothing.
    Sample sample(double uTexel, float u1, float u2, Part part = Part::Whole) const;
    /// The same density from a point of the square: points that are even there are even in the sky.
    Sample sampleSquare(double across, double down, Part part = Part::Whole) const;
    /// The point of the square that gives `direction`: {across, down}. Not for a black map.
    SquarePoint squareOf(Vec3 direction) const;

    bool black() const { return whole_.cells.empty(); }
    /// Integral of the radiance over all directions, as the density has it.
    Rgb integral() const { return integral_; }
    /// Share of it above its mean: 0 of a sky that is the same everywhere, near 1 where a small sun has
    /// all the light.
    double contrast() const { return above_.cells.total(); }
    /// What surfaces get of the part, by side. Not for a part that has nothing.
    SkySides sides(Part part) const;
    /// Density of what is drawn above the mean over that of the whole. 0 where there is no contrast.
    double aboveMean(Vec3 direction) const {
        return above_.cells.empty() ? 0.0 : aboveMeanAt(placeOf(direction));
    }

  private:
    static constexpr float kEvenPdfW = 0.25f / kPi;  ///< of a sky that is the same from everywhere

    // A cell lies between four centres of texels, those above it being of row y - 1 and those below
    // of row y, 0 <= y <= height. In the first and the last row of cells, half as high, both are the
    // same.
    struct Place {
        int x, y;             ///< of the cell; x is that of its left texels
        float right, bottom;  ///< share of what is on that side
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
        /// Where each row begins among them, and the end of the last one: close together, where those of
        /// the cells would each have to be fetched from afar.
        std::vector<double> rows;
    };
    const Table& table(Part part) const { return part == Part::Whole ? whole_ : above_; }
    Table tableOf(std::span<const double> weights) const;
    /// A cell's share of all directions, as far as it counts as not above the mean.
    double evenly(int row) const;
    const Rgb& texel(int x, int y) const { return image_[std::size_t(y) * width_ + x]; }

    int width_, height_;
    std::vector<Rgb> image_;
    struct Row {
        double top, bottom;  ///< cosines to +Y of its edges
        double solidAngle;   ///< of a cell: exact, so that densities integrate to one
    };
    std::vector<Row> rows_;  // of cells
    Table whole_;
    Table above_;  ///< by what is above the mean; its sum is the share of that
    Rgb integral_;
    bool even_ = false;  ///< one texel that is not black: the same from everywhere
    float turn_;         ///< rotation as a fraction of a whole turn
};

}  // namespace lacuna

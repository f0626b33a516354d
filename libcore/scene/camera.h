// Pinhole or thin-lens camera. All densities are per pixel: a pixel's eye paths are sampled
// uniformly over that pixel (box filter), so that W_e and p(z_1) are normalised over one pixel
// (theory.md, "Camera"; numerics.md, "Camera").
#pragma once

#include <array>
#include <optional>

#include "libcore/base/vec.h"
#include "libcore/scene/description.h"

namespace lacuna {

class Camera {
  public:
    struct Film {
        int width = 0, height = 0;
    };
    struct Lens {
        float radius = 0.0f;  ///< scene units; 0: pinhole
        float focus = 0.0f;   ///< distance of the plane in focus along the viewing axis, > 0
    };

    /// `offset` (the scene's centre) is subtracted from the camera's position. Pixels are square:
    /// the vertical angle is that of the file, and the horizontal one follows from the film. A
    /// shifted film lies beside the viewing axis, in the same plane.
    Camera(const CameraDescription& description, Vec3d offset, Film film, Lens lens);

    Film film() const { return film_; }
    /// The same camera with another film and the same vertical angle.
    Camera withFilm(Film film) const;
    Vec3 forward() const { return forward_; }
    Vec3 position() const { return position_; }

    /// Uniform point on the lens (the pinhole itself if the radius is 0); u in [0, 1)^2.
    Vec3 sampleLens(Vec2 u) const;

    struct Direction {
        Vec3 direction;  ///< unit, away from the lens
        float pdfW;      ///< density of the direction, per pixel, given the lens point
    };
    /// Ray from `lensPoint` through raster position (x right, y down, pixels).
    Direction directionAt(const Vec3& lensPoint, Vec2 raster) const;

    struct Projection {
        Vec2 raster;
        /// The density that directionAt would report for this direction. It is also W_e |cos|, with
        /// the lens's area left out on both sides: the importance for a splat.
        float pdfW;
    };
    /// The point where a ray that leaves `lensPoint` along the unit `direction` crosses the film;
    /// empty behind the camera or outside the film.
    std::optional<Projection> project(const Vec3& lensPoint, const Vec3& direction) const;

  private:
    void setFilm(Film film);

    Film film_;
    Lens lens_;
    Vec3 position_, right_, up_, forward_;
    double tangent_;               ///< tangent of half the vertical angle
    std::array<double, 2> shift_;  ///< CameraDescription::shift
    float tanX_, tanY_;
    float centreX_, centreY_;  ///< centre of the film on the image plane at distance 1
    float pixelArea_;          ///< on the image plane at distance 1
};

}  // namespace lacuna

#include "libcore/scene/camera.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/sampling.h"

namespace lacuna {

Camera::Camera(const CameraDescription& description, Vec3d offset, Film film, Lens lens)
    : lens_(lens), tangent_(std::tan(0.5 * description.yfov)), shift_(description.shift) {
    const Affine& m = description.toWorld;
    const Vec3d forward = normalize(-m.m[2]);
    const Vec3d right = normalize(cross(forward, m.m[1]));
    position_ = Vec3(m.m[3] - offset);
    forward_ = Vec3(forward);
    right_ = Vec3(right);
    up_ = Vec3(cross(right, forward));

    setFilm(film);
}

void Camera::setFilm(Film film) {
    film_ = film;
    const double tanY = tangent_;
    const double tanX = tanY * film.width / film.height;
    tanX_ = float(tanX);
    tanY_ = float(tanY);
    const double largerSide = 2.0 * std::max(tanX, tanY);
    centreX_ = float(shift_[0] * largerSide);
    centreY_ = float(shift_[1] * largerSide);
    pixelArea_ = float((2.0 * tanX / film.width) * (2.0 * tanY / film.height));
}

Camera Camera::withFilm(Film film) const {
    Camera other = *this;
    other.setFilm(film);
    return other;
}

Vec3 Camera::sampleLens(Vec2 u) const {
    if (lens_.radius == 0.0f) return position_;
    const Vec2 d = concentricDisk(u.x, u.y) * lens_.radius;
    return position_ + right_ * d.x + up_ * d.y;
}

Camera::Direction Camera::directionAt(const Vec3& lensPoint, Vec2 raster) const {
    const float x = (2.0f * raster.x / float(film_.width) - 1.0f) * tanX_ + centreX_;
    const float y = (1.0f - 2.0f * raster.y / float(film_.height)) * tanY_ + centreY_;
    Vec3 direction = forward_ + right_ * x + up_ * y;
    if (lens_.radius > 0.0f) {
        // Every ray through this raster position meets the pinhole's ray on the plane in focus.
        direction = direction * lens_.focus + (position_ - lensPoint);
    }
    direction = normalize(direction);
    const float cosine = dot(direction, forward_);
    return {direction, 1.0f / (pixelArea_ * cosine * cosine * cosine)};
}

std::optional<Camera::Projection> Camera::project(const Vec3& lensPoint,
                                                  const Vec3& direction) const {
    const float cosine = dot(direction, forward_);
    if (!(cosine > 1e-6f)) return std::nullopt;
    Vec3 q =
        direction * (1.0f / cosine);  // on the image plane at distance 1, seen from the pinhole
    if (lens_.radius > 0.0f) q += (lensPoint - position_) * (1.0f / lens_.focus);
    const Vec2 raster{((dot(q, right_) - centreX_) / tanX_ + 1.0f) * 0.5f * float(film_.width),
                      (1.0f - (dot(q, up_) - centreY_) / tanY_) * 0.5f * float(film_.height)};
    if (!(raster.x >= 0.0f && raster.x < float(film_.width) && raster.y >= 0.0f &&
          raster.y < float(film_.height))) {
        return std::nullopt;
    }
    return Projection{raster, 1.0f / (pixelArea_ * cosine * cosine * cosine)};
}

}  // namespace lacuna

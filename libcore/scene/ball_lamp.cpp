// (theory.md, "Balls")
#include "libcore/scene/ball_lamp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcore/base/octahedron.h"
#include "libcore/base/sampling.h"
#include "libcore/scene/light.h"

namespace lacuna {

namespace {

/// Tolerance that puts a point on an edge into at least one of its two faces.
constexpr float kRounding = 1e-5f;

/// Smallest distance, in radii, for sampling the cone: inside the sphere there is none, and close
/// to it the lamp does not look like a ball.
constexpr double kOutside = 1.0001;

/// Directions that are tried where some of them miss the lamp.
constexpr std::size_t kTries = 8;

}  // namespace

/// It emits about equally to all sides: its projected area is a quarter of its surface.
PlacedLight BallLamp::placed() const {
    const ShiningCone all{{0.0, 1.0, 0.0}, std::numbers::pi, false, false};
    return {lights_.front(), low_, high_, all, 0.25 * area_};
}

/// `distance2`: square of the distance from the middle.
bool BallLamp::isOutside(double distance2) const {
    return distance2 > kOutside * radius2_;
}

/// The cones of the sphere through the corners and of the one that touches the nearest face, seen from a point outside.
/// A sphere of radius r at the distance d, whose tangents have the length t, has a cone with 1 - cos = r^2 / (d (d + t)).
class BallLamp::Cones {
  public:
    Cones(const BallLamp& lamp, double distance2)
        : lamp_(lamp),
          distance_(std::sqrt(distance2)),
          outer_(distance_ + std::sqrt(distance2 - lamp.radius2_)),
          inner_(distance_ + std::sqrt(distance2 - lamp.within2_ * lamp.radius2_)) {}

    double distance() const { return distance_; }
    /// 1 - cos of the outer cone.
    double versine() const { return lamp_.radius2_ / (distance_ * outer_); }
    /// The inner cone as a share of the outer one: no direction in it misses the lamp.
    double innerShare() const { return lamp_.within2_ * outer_ / inner_; }
    /// The solid angle of the lamp as the sampled directions take it: the inner cone, and rimShare_ of what is around it.
    double expectedSolidAngle() const {
        // With one division.
        const double parts =
            (1.0 - lamp_.rimShare_) * lamp_.within2_ * outer_ + lamp_.rimShare_ * inner_;
        return 2.0 * std::numbers::pi * lamp_.radius2_ * parts / (distance_ * inner_ * outer_);
    }

  private:
    const BallLamp& lamp_;
    double distance_;
    double outer_, inner_;  // d + t
};

/// Maps the unit disk to the rays in the outer cone.
class BallLamp::Rays {
  public:
    Rays(const Cones& cones, double radius, const Vec3d& toMiddle)
        : radii_(cones.distance() / radius),
          versine_(cones.versine()),
          frame_(Vec3(toMiddle * (1.0 / cones.distance()))) {}

    struct Ray {
        Vec3 closest;  ///< point closest to the centre, relative to it and in radii
        Vec3 direction;
    };
    /// A uniform point of the disk becomes a uniform direction: 1 - cos is proportional to the square of the distance on
    /// the disk.
    Ray at(double diskX, double diskY) const {
        const double off = versine_ * (diskX * diskX + diskY * diskY);
        const double stretch = std::sqrt(versine_ * (2.0 - off));
        const double x = diskX * stretch, y = diskY * stretch, cosine = 1.0 - off;
        return {world(radii_ * cosine * x, radii_ * cosine * y, -radii_ * (x * x + y * y)),
                world(x, y, cosine)};
    }

  private:
    Vec3 world(double x, double y, double z) const {
        return frame_.toWorld({float(x), float(y), float(z)});
    }

    double radii_, versine_;
    Frame frame_;
};

std::optional<BallLamp::Point> BallLamp::sample(const Vec3& from, double u, float u1,
                                                float u2) const {
    const Vec3d toMiddle = middle_ - Vec3d(from);
    const double distance2 = lengthSquared(toMiddle);
    if (!isOutside(distance2)) {
        return Point{lights_[byArea_.sample(u).index], uniformTriangle(u1, u2)};
    }
    const Cones cones(*this, distance2);
    const Rays rays(cones, radius_, toMiddle);
    const auto enterAt = [&](double diskX, double diskY) {
        const Rays::Ray ray = rays.at(diskX, diskY);
        return enter(ray.closest, ray.direction);
    };
    const Vec2 onDisk = concentricDisk(u1, u2);
    const double x = double(onDisk.x), y = double(onDisk.y), square = x * x + y * y;
    // The rim has as much of the draws as it is expected to have of the lamp.
    const double sure = cones.innerShare(), used = sure + (1.0 - sure) * rimShare_;
    if (square * used <= sure) {
        const double shrink = std::sqrt(used);
        const std::optional<Entry> entry = enterAt(x * shrink, y * shrink);
        if (!entry) return std::nullopt;  // by rounding
        return Point{lights_[entry->face], entry->uv};
    }
    // Each try is uniform in the rim by itself; together they are spread over it.
    std::array<Entry, kTries> met;
    std::size_t hits = 0;
    const double part = (square * used - sure) / (used - sure), angle = std::atan2(y, x);
    for (std::size_t i = 0; i < kTries; ++i) {
        const double shifted = part + std::numbers::phi * double(i);
        const double r = std::sqrt(std::lerp(sure, 1.0, shifted - std::floor(shifted)));
        const double at = angle + 2.0 * std::numbers::pi * double(i) / double(kTries);
        if (const auto entry = enterAt(r * std::cos(at), r * std::sin(at))) met[hits++] = *entry;
    }
    if (hits == 0) return std::nullopt;
    const Entry& one = met[std::min(std::size_t(u * double(hits)), hits - 1)];
    return Point{lights_[one.face], one.uv, float(double(hits) / (rimShare_ * double(kTries)))};
}

double BallLamp::pdfA(const Vec3& from, const Vec3& position, const Vec3& normal) const {
    const double toMiddle2 = lengthSquared(middle_ - Vec3d(from));
    if (!isOutside(toMiddle2)) return 1.0 / area_;
    const Vec3d back = Vec3d(from) - Vec3d(position);
    const double facing = dot(Vec3d(normal), back);  // the cosine times the distance
    if (!(facing > 0.0)) return 0.0;
    const double distance2 = lengthSquared(back);
    const double solidAngle = Cones(*this, toMiddle2).expectedSolidAngle();
    return facing / (solidAngle * distance2 * std::sqrt(distance2));
}

/// The point where a ray enters the lamp. `closest`: the ray's point closest to the centre.
std::optional<BallLamp::Entry> BallLamp::enter(const Vec3& closest, const Vec3& direction) const {
    const float before = std::sqrt(std::max(0.0f, 1.0f - lengthSquared(closest)));
    const std::uint32_t near = startOf(closest - direction * before);
    if (dot(faces_[near].normal, direction) < 0.0f) return enterFrom(near, closest, direction);
    return enterFrom(startOf(-direction), closest, direction);
}

/// Walks from a face through whose plane the ray enters, across the edge outside of which the ray passes, to the next
/// face. The ray crosses each further plane later. If it leaves through the next plane, it has missed the lamp.
std::optional<BallLamp::Entry> BallLamp::enterFrom(std::uint32_t face, const Vec3& closest,
                                                   const Vec3& direction) const {
    for (std::size_t steps = 0; steps < faces_.size(); ++steps) {
        const Face& f = faces_[face];
        const float facing = dot(f.normal, direction);
        if (!(facing < 0.0f)) return std::nullopt;
        const float t = dot(f.normal, f.corner - closest) / facing;
        const Vec3 p = closest + direction * t - f.corner;
        const float b1 = dot(p, f.along1), b2 = dot(p, f.along2);
        const std::array<float, 3> b{1.0f - b1 - b2, b1, b2};
        const auto least = std::size_t(std::min_element(b.begin(), b.end()) - b.begin());
        if (b[least] >= -kRounding) {
            const float c1 = std::clamp(b1, 0.0f, 1.0f);
            return Entry{face, {c1, std::clamp(b2, 0.0f, 1.0f - c1)}};
        }
        face = f.across[least];
    }
    return std::nullopt;
}

std::uint32_t BallLamp::startOf(const Vec3& direction) const {
    const Vec2 p = octahedronPoint(direction);
    const auto cell = [&](float x) {
        return std::min(std::uint32_t(std::max(0.0f, 0.5f * (x + 1.0f) * float(cells_))),
                        cells_ - 1);
    };
    return starts_[cell(p.y) * cells_ + cell(p.x)];
}

void BallLamp::makeStarts() {
    cells_ = std::uint32_t(std::lround(std::sqrt(double(faces_.size()))));
    std::uint32_t face = 0;
    for (std::uint32_t i = 0; i < cells_ * cells_; ++i) {
        const auto middle = [&](std::uint32_t cell) {
            return (2.0f * float(cell) + 1.0f) / float(cells_) - 1.0f;
        };
        const Vec3 out = octahedronDirection({middle(i % cells_), middle(i / cells_)});
        // Any face that faces that way; the previous one mostly does.
        for (std::size_t n = 0; n < faces_.size() && dot(faces_[face].normal, out) <= 0.0f; ++n) {
            face = std::uint32_t((face + 1) % faces_.size());
        }
        if (const auto entry = enterFrom(face, {}, -out)) face = entry->face;
        starts_.push_back(face);
    }
}

}  // namespace lacuna

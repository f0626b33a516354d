#include "libcore/specular/triangles_by_area.h"

#include <cmath>
#include <utility>

#include "libcore/scene/triangle.h"

namespace lacuna {

TrianglesByArea::TrianglesByArea(std::vector<std::array<Vec3, 3>> triangles)
    : triangles_(std::move(triangles)) {
    std::vector<double> areas;
    areas.reserve(triangles_.size());
    for (const auto& [a, b, c] : triangles_) {
        areas.push_back(length(cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a))));
        area_ += areas.back() / 2;
    }
    byArea_ = DiscreteDistribution(areas);
}

TrianglesByArea::Point TrianglesByArea::sample(Rng& rng) const {
    const std::uint32_t triangle = byArea_.sample(rng.uniformDouble()).index;
    const auto& [a, b, c] = triangles_[triangle];
    const float root = std::sqrt(rng.uniform()), along = rng.uniform();
    return {a + (b - a) * (root * (1.0f - along)) + (c - a) * (root * along), triangle};
}

Vec3 TrianglesByArea::normal(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles_[triangle];
    return triangleNormal(a, b, c);
}

}  // namespace lacuna

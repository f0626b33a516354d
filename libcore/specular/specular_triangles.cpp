#include "libcore/specular/specular_triangles.h"

#include <cmath>

namespace lacuna {

SpecularTriangles::SpecularTriangles(const Scene& scene)
    : triangles_(scene.trianglesOf(mayBeSpecular)) {
    std::vector<double> areas;
    areas.reserve(triangles_.size());
    for (const auto& [a, b, c] : triangles_) {
        areas.push_back(length(cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a))));
    }
    byArea_ = DiscreteDistribution(areas);
}

Vec3 SpecularTriangles::samplePoint(Rng& rng) const {
    const auto& [a, b, c] = triangles_[byArea_.sample(rng.uniformDouble()).index];
    const float root = std::sqrt(rng.uniform()), along = rng.uniform();
    return a + (b - a) * (root * (1.0f - along)) + (c - a) * (root * along);
}

}  // namespace lacuna

// (theory.md, "Next event through glass")
#include "libcore/specular/glass_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna {

namespace {
constexpr int kDivisions = 5;
}

float boxMargin(const Scene& scene) {
    constexpr float kMargin = 1e-4f;
    return kMargin * scene.radius();
}

std::vector<BoxedTriangles> glassInBoxes(const Scene& scene) {
    return inBoxes(scene.trianglesOf(mayBeClearGlass), kDivisions, boxMargin(scene));
}

std::vector<BoxedTriangles> facetsInBoxes(const Scene& scene) {
    return inBoxes(scene.trianglesOf([](const Material& material) {
        return mayBeNarrowGlass(material) && stopsAllRays(material);
    }),
                   kDivisions, boxMargin(scene));
}

GlassBoxes::GlassBoxes(std::span<const BoxedTriangles> glass) {
    for (const BoxedTriangles& part : glass) boxes_.push_back(part.box);
    if (!glass.empty()) whole_ = around(glass);
}

bool GlassBoxes::mayLieOn(const Vec3& origin, const Vec3& way, bool forEver) const {
    const float farthest = forEver ? std::numeric_limits<float>::infinity() : 1.0f;
    const Vec3 inverse{1.0f / way.x, 1.0f / way.y, 1.0f / way.z};
    const auto meets = [&](const Box& box) {
        float from = 0.0f, to = farthest;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float o = origin[axis], i = inverse[axis];
            if (std::isinf(i)) {
                if (o < box.low[axis] || o > box.high[axis]) return false;
                continue;
            }
            const float a = (box.low[axis] - o) * i, b = (box.high[axis] - o) * i;
            from = std::max(from, std::min(a, b));
            to = std::min(to, std::max(a, b));
        }
        return from <= to;
    };
    return !boxes_.empty() && meets(whole_) && std::ranges::any_of(boxes_, meets);
}

}  // namespace lacuna

#include "libcore/specular/glass_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace lacuna {

namespace {

using Triangle = std::array<Vec3, 3>;

constexpr int kDivisions = 5;     // of each part in two: at most 32 boxes
constexpr float kMargin = 1e-4f;  // of the scene's radius: rays leave surfaces by an offset

float at(const Vec3& v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

Vec3 middleOf(const Triangle& t) {
    return (t[0] + t[1] + t[2]) * (1.0f / 3.0f);
}

}  // namespace

GlassBoxes::GlassBoxes(const Scene& scene) {
    std::vector<Triangle> triangles = scene.trianglesOf([](const Material& material) {
        return mayBeSmoothGlass(material) && stopsAllRays(material);
    });
    const float wide = kMargin * scene.radius();
    const Vec3 margin{wide, wide, wide};
    const auto enclose = [&](std::span<const Triangle> part) {
        Box box{part[0][0], part[0][0]};
        for (const Triangle& triangle : part) {
            for (const Vec3& corner : triangle) {
                box.low = min(box.low, corner);
                box.high = max(box.high, corner);
            }
        }
        return Box{box.low - margin, box.high + margin};
    };
    // In two at the middle of the longest side, while there are triangles on both sides.
    const auto divide = [&](auto&& again, std::span<Triangle> part, int divisions) -> void {
        if (part.empty()) return;
        const Box box = enclose(part);
        const Vec3 size = box.high - box.low;
        const int axis = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
        const float middle = 0.5f * (at(box.low, axis) + at(box.high, axis));
        const auto second = std::stable_partition(part.begin(), part.end(), [&](const Triangle& t) {
            return at(middleOf(t), axis) < middle;
        });
        const auto first = std::size_t(second - part.begin());
        if (divisions == 0 || first == 0 || first == part.size()) {
            boxes_.push_back(box);
            return;
        }
        again(again, part.first(first), divisions - 1);
        again(again, part.subspan(first), divisions - 1);
    };
    if (!triangles.empty()) whole_ = enclose(triangles);
    divide(divide, triangles, kDivisions);
}

bool GlassBoxes::mayLieOn(const Vec3& origin, const Vec3& way, bool forEver) const {
    const float farthest = forEver ? std::numeric_limits<float>::infinity() : 1.0f;
    const Vec3 inverse{1.0f / way.x, 1.0f / way.y, 1.0f / way.z};
    const auto meets = [&](const Box& box) {
        float from = 0.0f, to = farthest;
        for (int axis = 0; axis < 3; ++axis) {
            const float o = at(origin, axis), i = at(inverse, axis);
            if (std::isinf(i)) {
                if (o < at(box.low, axis) || o > at(box.high, axis)) return false;
                continue;
            }
            const float a = (at(box.low, axis) - o) * i, b = (at(box.high, axis) - o) * i;
            from = std::max(from, std::min(a, b));
            to = std::min(to, std::max(a, b));
        }
        return from <= to;
    };
    return meets(whole_) && std::ranges::any_of(boxes_, meets);
}

}  // namespace lacuna

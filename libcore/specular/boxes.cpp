#include "libcore/specular/boxes.h"

#include <algorithm>

namespace lacuna {

namespace {

using Triangle = std::array<Vec3, 3>;

std::size_t longestAxis(const Box& box) {
    const Vec3 size = box.high - box.low;
    return size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
}

/// Divides a part in two at the middle of its longest side, as long as there are triangles
/// on both sides.
void divide(std::span<Triangle> part, int divisions, float margin,
            std::vector<BoxedTriangles>& out) {
    if (part.empty()) return;
    const Box box = around(part, margin);
    const std::size_t axis = longestAxis(box);
    const float middle = 0.5f * (box.low[axis] + box.high[axis]);
    const auto second = std::stable_partition(part.begin(), part.end(), [&](const Triangle& t) {
        return (t[0][axis] + t[1][axis] + t[2][axis]) * (1.0f / 3.0f) < middle;
    });
    const auto first = std::size_t(second - part.begin());
    if (divisions == 0 || first == 0 || first == part.size()) {
        out.push_back({box, {part.begin(), part.end()}});
        return;
    }
    divide(part.first(first), divisions - 1, margin, out);
    divide(part.subspan(first), divisions - 1, margin, out);
}

}  // namespace

std::vector<BoxedTriangles> inBoxes(std::vector<Triangle> triangles, int divisions, float margin) {
    std::vector<BoxedTriangles> parts;
    divide(triangles, divisions, margin, parts);
    return parts;
}

Box around(std::span<const Triangle> triangles, float margin) {
    Box box{triangles[0][0], triangles[0][0]};
    for (const Triangle& triangle : triangles) {
        for (const Vec3& corner : triangle) {
            box.low = min(box.low, corner);
            box.high = max(box.high, corner);
        }
    }
    const Vec3 wide{margin, margin, margin};
    return Box{box.low - wide, box.high + wide};
}

Box around(std::span<const BoxedTriangles> parts) {
    Box all = parts[0].box;
    for (const BoxedTriangles& part : parts) {
        all.low = min(all.low, part.box.low);
        all.high = max(all.high, part.box.high);
    }
    return all;
}

/// The points at a share t of the way from one box to the other fill a box, whose sides are linear in t.
bool mayLieBetween(const Box& third, const Box& one, const Box& other) {
    float from = 0.0f, to = 1.0f;
    const auto atMost = [&](float slope, float bound) {  // slope t <= bound
        if (slope > 0.0f) {
            to = std::min(to, bound / slope);
        } else if (slope < 0.0f) {
            from = std::max(from, bound / slope);
        } else if (bound < 0.0f) {
            to = -1.0f;
        }
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float low = one.low[axis], high = one.high[axis];
        atMost(other.low[axis] - low, third.high[axis] - low);
        atMost(high - other.high[axis], high - third.low[axis]);
    }
    return from <= to;
}

}  // namespace lacuna

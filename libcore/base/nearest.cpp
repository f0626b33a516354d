#include "libcore/base/nearest.h"

#include <algorithm>
#include <array>
#include <nanoflann.hpp>
#include <utility>

namespace lacuna {

namespace {

constexpr std::size_t kPointsPerLeaf = 8;
constexpr std::size_t kStackResults = 16;

struct Points {
    std::vector<Vec3> points, sides;  // sides, times sideLength

    // Names that nanoflann asks for.
    std::size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const {
        const Vec3& p = axis < 3 ? points[i] : sides[i];
        const std::size_t a = axis % 3;
        return a == 0 ? p.x : a == 1 ? p.y : p.z;
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>,
                                                 Points, 6, std::uint32_t>;

}  // namespace

struct NearestPoints::Impl {
    Impl(std::vector<Vec3> p, std::vector<Vec3> s, float length)
        : sideLength(length),
          points{std::move(p), std::move(s)},
          tree(6, points, {kPointsPerLeaf}) {}
    float sideLength;
    Points points;
    Tree tree;
};

NearestPoints::NearestPoints() = default;
NearestPoints::NearestPoints(std::vector<Vec3> points, std::vector<Vec3> sides, float sideLength) {
    if (!points.empty()) {
        for (Vec3& side : sides) side = side * sideLength;
        impl_ = std::make_unique<Impl>(std::move(points), std::move(sides), sideLength);
    }
}
NearestPoints::~NearestPoints() = default;
NearestPoints::NearestPoints(NearestPoints&&) noexcept = default;
NearestPoints& NearestPoints::operator=(NearestPoints&&) noexcept = default;

std::size_t NearestPoints::size() const {
    return impl_ ? impl_->points.points.size() : 0;
}

std::size_t NearestPoints::find(Vec3 p, Vec3 side, std::span<std::uint32_t> out) const {
    if (!impl_ || out.empty()) return 0;
    const Vec3 s = side * impl_->sideLength;
    const float query[6] = {p.x, p.y, p.z, s.x, s.y, s.z};
    std::array<float, kStackResults> few;
    std::vector<float> many;
    float* distances = few.data();
    if (out.size() > few.size()) {
        many.resize(out.size());
        distances = many.data();
    }
    return impl_->tree.knnSearch(query, out.size(), out.data(), distances);
}

}  // namespace lacuna

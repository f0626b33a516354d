#include "libcore/bidir/photon_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lacuna {

PhotonGrid::PhotonGrid(std::span<const PathVertex> vertices, std::span<const std::uint32_t> photons,
                       double radius)
    : radius_(radius) {
    if (photons.empty()) return;
    double largest = 0;
    for (const std::uint32_t i : photons) {
        const Vec3& p = vertices[i].position;
        for (const float x : {p.x, p.y, p.z}) largest = std::max(largest, double(std::fabs(x)));
    }
    // Twice the radius, so that eight cells hold every neighbour; not so small that a cell's number
    // leaves the range of integers.
    cell_ = std::max({2.0 * radius, largest * 0x1p-40, 1e-300});

    const std::size_t buckets = std::bit_ceil(photons.size());
    begins_.assign(buckets + 1, 0);
    std::vector<std::uint32_t> bucket;
    bucket.reserve(photons.size());
    for (const std::uint32_t i : photons) {
        const Vec3& p = vertices[i].position;
        bucket.push_back(std::uint32_t(bucketOf(cellOf(p.x), cellOf(p.y), cellOf(p.z))));
        ++begins_[bucket.back() + 1];
    }
    for (std::size_t b = 0; b < buckets; ++b) begins_[b + 1] += begins_[b];
    photons_.resize(photons.size());
    std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
    for (std::size_t n = 0; n < photons.size(); ++n) {
        photons_[next[bucket[n]]++] = {vertices[photons[n]].position, photons[n]};
    }
}

std::size_t PhotonGrid::bytes() const {
    return photons_.size() * sizeof(Photon) + begins_.size() * sizeof(std::uint32_t);
}

std::int64_t PhotonGrid::cellOf(float x) const {
    return std::int64_t(std::floor(double(x) / cell_));
}

std::int64_t PhotonGrid::firstCell(float x) const {
    // An eye vertex may lie far outside of all photons.
    constexpr double kFar = 0x1p60;
    return std::int64_t(std::clamp(std::floor(double(x) / cell_ - 0.5), -kFar, kFar));
}

std::size_t PhotonGrid::bucketOf(std::int64_t x, std::int64_t y, std::int64_t z) const {
    std::uint64_t h = std::uint64_t(x) * 0x9e3779b97f4a7c15u;
    h = (h ^ std::uint64_t(y)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 29) ^ std::uint64_t(z)) * 0x94d049bb133111ebu;
    return std::size_t(h ^ (h >> 32)) & (begins_.size() - 2);
}

void PhotonGrid::find(const Vec3& place, std::vector<std::uint32_t>& found) const {
    if (photons_.empty()) return;
    const std::int64_t x = firstCell(place.x), y = firstCell(place.y), z = firstCell(place.z);
    // Two cells may share a bucket, which must be looked into once.
    std::array<std::size_t, 8> buckets;
    std::size_t count = 0;
    for (int i = 0; i < 8; ++i) {
        const std::size_t b = bucketOf(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
        if (std::find(buckets.begin(), buckets.begin() + count, b) == buckets.begin() + count) {
            buckets[count++] = b;
        }
    }
    const double within = radius_ * radius_;
    for (std::size_t n = 0; n < count; ++n) {
        const std::size_t end = begins_[buckets[n] + 1];
        for (std::size_t i = begins_[buckets[n]]; i < end; ++i) {
            if (lengthSquared(Vec3d(photons_[i].position) - Vec3d(place)) < within) {
                found.push_back(photons_[i].vertex);
            }
        }
    }
}

}  // namespace lacuna

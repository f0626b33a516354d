// Cache points: vertices of eye subpaths of their own, which add nothing to the image, at which
// light vertices are weighed for all eye vertices nearby [Popov15], [Nabata20a 5].
//
// A new set is traced for every iteration, before its light paths, so a set is frozen data for the
// weights. An eye vertex is served by the N_c points nearest to the point that is nearest to it:
// one query per vertex, and what belongs together lies together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/nearest.h"
#include "libcore/bidir/method.h"

namespace lacuna {

class CachePoints {
  public:
    /// No points: everything is served by nobody.
    CachePoints() = default;
    /// All connectable vertices of `density` x (pixels of the film) eye subpaths, at least one
    /// path. `neighbours`: N_c. `generation` addresses the random numbers.
    CachePoints(IterationContext& context, double density, int neighbours,
                std::uint32_t generation);

    std::size_t size() const { return points_.size(); }
    bool empty() const { return points_.empty(); }
    /// The point as the end of an eye subpath: its predecessor and itself.
    Subpath eye(std::uint32_t point) const { return {vertices_.data() + points_[point] - 1, 2}; }
    Vec3 position(std::uint32_t point) const { return vertices_[points_[point]].position; }

    /// The point that serves an eye vertex: its tag where it has one; kNone where there are none.
    std::uint32_t serving(const PathVertex& vertex) const {
        return vertex.tag != kNone ? vertex.tag : nearest(vertex.position);
    }
    std::uint32_t nearest(Vec3 position) const;
    /// min(N_c, size()) points, the serving one first; none for kNone.
    std::span<const std::uint32_t> around(std::uint32_t serving) const {
        if (serving == kNone) return {};
        return std::span(around_).subspan(serving * perPoint_, perPoint_);
    }
    /// Up to out.size() points by distance from `position`; returns how many.
    std::size_t find(Vec3 position, std::span<std::uint32_t> out) const {
        return nearest_.find(position, out);
    }

    /// Upper limit of G in everything that is kept at a point: a light vertex closer than the
    /// point's neighbours are says little about the vertices that it serves, and may be infinitely
    /// close. Never a limit on what is carried.
    double geometryLimit(std::uint32_t point) const { return geometryLimit_[point]; }

    std::uint64_t bytes() const;

  private:
    std::vector<PathVertex> vertices_;   // whole eye subpaths
    std::vector<std::uint32_t> points_;  // index into vertices_
    std::vector<std::uint32_t> around_;  // perPoint_ each
    std::vector<double> geometryLimit_;
    std::size_t perPoint_ = 0;
    NearestPoints nearest_;
};

/// Values at the points of one set, carried over to another: each new point takes the mean of the
/// `count` old ones nearest to it (N_q). Zero where there are no old points.
std::vector<double> carriedOver(const CachePoints& from, std::span<const double> values,
                                const CachePoints& to, int count, const ThreadPool& threads);

}  // namespace lacuna

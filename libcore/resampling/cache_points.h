// Cache points: vertices of eye subpaths of their own, which add nothing to the image, at which
// light vertices are weighed for all eye vertices nearby [Popov15], [Nabata20a 5]. (theory.md,
// "Cache points")
//
// A new set is traced for every iteration, before its light paths, so a set is frozen data for the
// weights. The point nearest to an eye vertex serves it, together with that point's own nearest
// neighbours, N_c points in all. So a vertex takes one query.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "libcore/base/nearest.h"
#include "libcore/bidir/method.h"

namespace lacuna {

class CachePoints {
  public:
    /// No points: no vertex is served.
    CachePoints() = default;
    /// The connectable vertices of `density` x (pixels of the film) eye subpaths, at least one
    /// path. `neighbours` is N_c. `generation` addresses the random numbers.
    CachePoints(IterationContext& context, double density, int neighbours,
                std::uint32_t generation);

    std::size_t size() const { return points_.size(); }
    bool empty() const { return points_.empty(); }
    /// The point as the end of an eye subpath: its predecessor and itself.
    Subpath eye(std::uint32_t point) const { return {vertices_.data() + points_[point] - 1, 2}; }
    Vec3 position(std::uint32_t point) const { return vertices_[points_[point]].position; }
    /// The side of its surface that it lies on.
    Vec3 side(std::uint32_t point) const { return scatteringSide(vertices_[points_[point]]); }

    /// The point that serves an eye vertex, which is also the vertex's label; kNone where there are
    /// no points. `label` is the vertex's, or kNone where it is not known.
    std::uint32_t serving(const PathVertex& eye, Label label) const {
        return label != kNone ? label : nearest(eye);
    }
    /// Labels a walk's vertices as eye vertices, whichever walk it is.
    void labelAsEye(std::span<PathVertex> walk) const;
    /// min(N_c, size()) points, the serving one first; none for kNone.
    std::span<const std::uint32_t> around(std::uint32_t serving) const {
        if (serving == kNone) return {};
        return std::span(around_).subspan(serving * perPoint_, perPoint_);
    }

    /// Upper limit of 1 / d^2 in everything that is kept at a point: a light vertex closer than the
    /// point's neighbours are says little about the vertices that it serves, and may be infinitely
    /// close. It never limits a contribution.
    double inverseSquareLimit(std::uint32_t point) const { return limit_[point]; }
    /// G, or `share` of that limit where G is larger. At infinity G is a cosine: there is no
    /// distance to limit.
    double limited(std::uint32_t point, const PathVertex& light, double geometry,
                   double share = 1.0) const {
        return light.infinite() ? geometry : std::min(geometry, share * limit_[point]);
    }
    /// The G between an eye vertex and a light vertex that weights may trust. `geometry` is the
    /// true one; the result is no larger than the G that the pmf at the point knows. A light vertex
    /// is picked rarely if it is near the eye vertex and not near the point, or lies behind the
    /// point's surface, which scatters nothing of it. No weight must count on such picks.
    double trustedGeometry(std::uint32_t point, const PathVertex& light, double geometry) const;

    std::uint64_t bytes() const;

    /// The search structure alone: all that is needed of a set whose iteration is over.
    NearestPoints takeNearest() && { return std::move(nearest_); }

  private:
    std::uint32_t nearest(const PathVertex& vertex) const;

    std::vector<PathVertex> vertices_;   // whole eye subpaths
    std::vector<std::uint32_t> points_;  // index into vertices_
    std::vector<std::uint32_t> around_;  // perPoint_ each
    std::vector<double> limit_;          // of 1 / d^2
    std::size_t perPoint_ = 0;
    NearestPoints nearest_;
};

/// Values that earlier iterations found at their cache points, to be read at new ones: the frozen
/// normalisers Q. Holds the last `sets` sets.
class EarlierValues {
  public:
    /// `columns` values per point. `count` is N_q.
    EarlierValues(int columns, int sets, int count)
        : columns_(std::size_t(columns)), sets_(std::size_t(sets)), count_(std::size_t(count)) {}

    /// Adds a set, and drops the oldest one where there are too many. A set without
    /// points is not added.
    void add(CachePoints points, std::vector<double> values);
    /// For each new point the mean over all sets of the mean over the N_q points nearest to it:
    /// columns values each. Zero without sets.
    std::vector<double> at(const CachePoints& points, const ThreadPool& threads) const;

  private:
    struct Set {
        NearestPoints nearest;
        std::vector<double> values;
    };
    std::size_t columns_, sets_, count_;
    std::deque<Set> history_;
};

}  // namespace lacuna

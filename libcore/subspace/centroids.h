// Centroids of subspaces. A subpath belongs to the subspace whose centroid is nearest by this
// distance. (theory.md, "Subspaces")
//
//     kappa(y) = argmin_i d(C_i, y)                                                [Su22 eq 17]
//     d = d_s^2 + sigma^2 (1 - cos theta_n) + k_d sigma^2 (1 - cos theta_d)        [Su22 eq 18]
//
// d_s: distance of the last vertices; theta_n, theta_d: between their normals and between their
// incident directions; sigma^2: largest of the three variances of the vertices' coordinates.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/rng.h"
#include "libcore/subspace/subpath_end.h"

namespace lacuna {

class Centroids {
  public:
    /// No centroid: nearest() is 0 for everything.
    Centroids() = default;
    /// `directionWeight` is k_d.
    Centroids(std::span<const SubpathEnd> centres, float sigma2, float directionWeight = 0.05f);

    std::size_t size() const { return size_; }
    /// Index of the nearest; of equally near ones the first.
    std::uint32_t nearest(const SubpathEnd& end) const;
    /// Indices of the `most` nearest, or of all where there are fewer; nearest first, of equally
    /// near ones the first.
    std::vector<std::uint32_t> nearest(const SubpathEnd& end, std::size_t most) const;
    /// d(C_index, end) as above.
    float distance(std::size_t index, const SubpathEnd& end) const;

  private:
    std::size_t size_ = 0;
    float sigma2_ = 0.0f, directionWeight_ = 0.0f;
    std::vector<float> value_;  // attribute by attribute, so that loops over centroids vectorise
};

/// Largest of the three variances of the ends' coordinates; 0 for none.
float spatialVariance(std::span<const SubpathEnd> ends);

/// Draws up to `count` different ones of `ends` in proportion to their weights. The weight of a
/// subpath's end is the contribution of the paths that it is part of [Su22 7.2.2]. There is one
/// draw out of each `count`-th of the sum of weights. Weights that are not positive and finite
/// count as zero.
std::vector<SubpathEnd> drawCentroids(std::span<const SubpathEnd> ends,
                                      std::span<const float> weights, std::size_t count, Rng& rng);

}  // namespace lacuna

// A learned distribution of emission, from paths that reach the picture: which light emits, which
// part of it, and in which directions; for lights at infinity, from which part of the disk that
// covers the scene. It is frozen while rendering. (theory.md, "Learned emission")
//
// Every light maps its points to a unit square on which they are uniform without a guide, and the rays that leave a
// point to another one (Lights::pointSquare, Lights::raySquare). The guide is a density on these squares, relative to
// the density without a guide.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/base/square_density.h"
#include "libcore/scene/ray.h"

namespace lacuna {

struct EmissionGuide {
    /// Probability of each light, by index. It sums to one and is positive for each light with
    /// power.
    std::vector<double> pmf;
    /// By light: index of its tree in `points`; kNone: nothing was learned.
    std::vector<std::uint32_t> pointTree;
    std::vector<SquareDensity> points;
    /// rayTree: by tree of `points` and leaf, the index of the leaf's tree in `rays`; kNone: nothing was learned. The
    /// leaves of tree i begin at firstLeaf[i].
    std::vector<std::uint32_t> firstLeaf, rayTree;
    std::vector<SquareDensity> rays;

    /// The guide at one point.
    struct Here {
        double pdf = 1.0;                     ///< density of the point on its square
        const SquareDensity* rays = nullptr;  ///< density of rays that leave it; null: uniform
    };
    Here at(std::uint32_t light, SquarePoint point) const {
        const std::uint32_t tree = pointTree[light];
        if (tree == kNone) return {};
        const SquareDensity::Place place = points[tree].at(point);
        const std::uint32_t ofRays = rayTree[firstLeaf[tree] + place.leaf];
        return {place.pdf, ofRays == kNone ? nullptr : &rays[ofRays]};
    }

    /// Throws std::invalid_argument naming a part that is inconsistent or does not fit `lights`
    /// lights.
    void check(std::size_t lights) const;
    /// Hash of everything above, in hexadecimal digits.
    std::string contentHash() const;
};

}  // namespace lacuna

// Where light subpaths begin and set out, learned from paths that reach the picture: which light,
// which part of it, which directions from there; of lights at infinity, which part of the disk that
// covers the scene. Frozen. (theory.md, "Learned emission")
//
// Every light has a square that its points are spread over evenly, and one for the ray that leaves a
// point (Lights::pointSquare, Lights::raySquare). The guide is a density on these squares, relative to
// what a light does without it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/base/square_density.h"
#include "libcore/scene/ray.h"

namespace lacuna {

struct EmissionGuide {
    /// Probability of each light, by index; sums to one, and is positive where the light has power.
    std::vector<double> pmf;
    /// What is known of a light: its tree of `points`; kNone: nothing.
    std::vector<std::uint32_t> pointTree;
    std::vector<SquareDensity> points;
    /// By tree of `points` and leaf: the leaf's tree of `rays`, kNone: nothing. Those of tree i begin
    /// at firstLeaf[i].
    std::vector<std::uint32_t> firstLeaf, rayTree;
    std::vector<SquareDensity> rays;

    /// The guide of one point.
    struct Here {
        double pdf = 1.0;                     ///< of the point, on its square
        const SquareDensity* rays = nullptr;  ///< for what leaves it; null: even
    };
    Here at(std::uint32_t light, SquarePoint point) const {
        const std::uint32_t tree = pointTree[light];
        if (tree == kNone) return {};
        const SquareDensity::Place place = points[tree].at(point);
        const std::uint32_t ofRays = rayTree[firstLeaf[tree] + place.leaf];
        return {place.pdf, ofRays == kNone ? nullptr : &rays[ofRays]};
    }

    /// Throws std::invalid_argument naming what does not fit together, or does not fit `lights`
    /// lights.
    void check(std::size_t lights) const;
    /// Of everything above, as hexadecimal digits.
    std::string contentHash() const;
};

}  // namespace lacuna

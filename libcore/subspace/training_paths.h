// D: full paths, with the data that classification and Gamma need of them [Su22 7.1].
// (theory.md, "Subspaces")
//
// Paths come from bidirectional path tracing (M = 1, r = 1) with all its strategies, each sampled
// path once, under the density p_D = sum_i n_i p_i. The balance heuristic's weights are
// w_t = n_t p_t / p_D, so that a weighted contribution is f / p_D, and in the units of p_D
//     g_0 / p_D  = w_1 + w_{k+1}
//     g_ij / p_D = sum over t in 2..k with the labels (i, j) of  N w_t beta_{s-1} / Q(i)
// with beta_{s-1} the throughput that arrives at x_{s-1}: p(z) f_y = p_t beta.       [Su22 eq 16]
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libcore/bidir/mis.h"
#include "libcore/subspace/gamma.h"
#include "libcore/subspace/relative_contribution.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna {

class TrainingPaths {
  public:
    struct Vertex {
        Vec3 position, normal;
        float strength;  ///< w_t beta of the strategy whose light subpath ends here; 0: none
    };
    struct Path {
        std::uint64_t firstVertex;
        std::uint32_t pixel, lightCell;
        float contribution;  ///< f / p_D; relative to the pixel once relate() was called
        float fixed;         ///< g_0 / p_D
        std::uint16_t edges;
        bool infiniteSource;
    };

    /// Adds a path that bidirectional path tracing made, with its weighted contribution (mean of
    /// the channels). Paths that no connection makes are left out. Fills path.beta.
    void add(FullPath& path, const TechniqueCounts& counts, const LightCells& cells,
             float contribution, std::uint32_t pixel);
    /// Adds path `index` of another set.
    void append(const TrainingPaths& other, std::size_t index);

    /// Divides contributions by what their pixels show.
    void relate(const PixelScale& scale);
    /// The outlierLimit() of the contributions (relative_contribution.h).
    float outlierLimit() const;
    /// Lowers larger contributions to the limit. Returns how many there were.
    std::size_t lowerTo(float limit);

    std::size_t size() const { return paths_.size(); }
    std::uint32_t pixel(std::size_t index) const { return paths_[index].pixel; }
    const Path& path(std::size_t index) const { return paths_[index]; }
    std::uint64_t bytes() const;

    /// The strength of the path's connection s, in [1, edges). Zero where there is none.
    float strength(const Path& path, int s) const { return vertex(path, s - 1).strength; }
    /// Ends of the two subpaths of connection s: x_{s-1} (s >= 2) and x_s.
    SubpathEnd lightEnd(const Path& path, int s) const;
    SubpathEnd eyeEnd(const Path& path, int s) const;

  private:
    const Vertex& vertex(const Path& path, int i) const {
        return vertices_[path.firstVertex + std::uint64_t(i)];
    }

    std::vector<Path> paths_;
    std::vector<Vertex> vertices_;
};

/// The paths as the loss sees them, under the labels, Q and cells of `subspaces`. `picks` is N.
GammaData gammaData(const TrainingPaths& paths, const Subspaces& subspaces, int picks,
                    const ThreadPool& pool);

}  // namespace lacuna

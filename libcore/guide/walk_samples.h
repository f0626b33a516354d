// Paths as guided walks see them: at each vertex that scatters smoothly, or may do so, the direction in which either
// walk goes on, and how much of the picture's second moment depends on it. (theory.md, "Guided walks")
//
// Paths come from bidirectional path tracing with all its strategies, each sampled path once under
// p_D = sum_t p_t, with the weights w_t. If strategy t of the method that is to be guided stands for W_t samples, the
// method's paths have the density p_D d, d = sum_t W_t w_t. With g = f / (p_D d), the second moment of those strategies
// that drew a step is the mean over the paths of g^2 times their W_t w_t.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/mis.h"
#include "libcore/bidir/walk.h"
#include "libcore/bidir/walk_guide.h"
#include "libcore/guide/technique_worth.h"
#include "libcore/subspace/relative_contribution.h"

namespace lacuna {

class WalkSamples {
  public:
    /// A walk's step away from a vertex.
    struct Step {
        WalkGuide::Place place;
        Vec3 to;         ///< unit
        float weight;    ///< sum of W_t w_t over the strategies that drew it
        float pdfBsdf;   ///< pdfW of the BSDF alone; of a delta event the generalised one
        float pdfFound;  ///< pdfW that it was drawn with when it was found
        Side side;       ///< whose walk
        bool delta;
    };
    struct Path {
        std::uint32_t pixel, first, count;
        float contribution;  ///< g; relative to the pixel once relate() was called
    };

    /// Adds a path that bidirectional path tracing made with `walker`, with its weighted contribution
    /// f / p_D (mean of the channels). Paths without a step are left out, and those that none of the
    /// method's strategies makes.
    void add(FullPath& path, const TechniqueCounts& counts, const Walker& walker,
             const TechniqueWorth& worth, float contribution, std::uint32_t pixel);
    void append(const WalkSamples& other, std::size_t index);
    /// Adds a path of these steps. `contribution` is its g.
    void put(std::uint32_t pixel, float contribution, std::span<const Step> steps);
    /// Divides contributions by what their pixels show.
    void relate(const PixelScale& scale);
    /// The outlierLimit() of the contributions (relative_contribution.h).
    float outlierLimit() const;
    /// Lowers larger contributions to the limit.
    void lowerTo(float limit);

    std::size_t size() const { return paths_.size(); }
    std::uint32_t pixel(std::size_t index) const { return paths_[index].pixel; }
    std::span<const Path> paths() const { return paths_; }
    std::span<const Step> steps(const Path& path) const {
        return std::span(steps_).subspan(path.first, path.count);
    }

  private:
    std::vector<Path> paths_;
    std::vector<Step> steps_;
};

/// The step's second moment if its direction had the density pdfW = 1. It is to be divided by the density that the
/// direction is to have.
double momentOf(const WalkSamples::Path& path, const WalkSamples::Step& step);

}  // namespace lacuna

// Paths as learned emission sees them: where on the light they begin, along which ray they leave, and how much of the
// picture's second moment depends on that. (theory.md, "Learned emission")
//
// Paths come from bidirectional path tracing with all its strategies, each sampled path once, under
// p_D = sum_i p_i. A strategy of s >= 2 light vertices draws both y_0 and the ray, one of s = 1 draws
// y_0 alone. Let w be the sum of the weights of the former. If each of them stands for W samples, the density of the
// path is p_D d with d = 1 - w + W w. With g = f / (p_D d) relative to the pixel, their second moment is the mean over
// the paths of g^2 W w. If y_0 and the ray had another density p' instead of today's p, it would be the same mean with
// a factor p / p'.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/mis.h"
#include "libcore/subspace/relative_contribution.h"

namespace lacuna {

class EmissionSamples {
  public:
    struct Sample {
        std::uint32_t light, pixel;
        SquarePoint point, ray;  ///< on the light's squares (Lights::pointSquare, raySquare)
        float contribution;      ///< f / p_D; relative to the pixel once relate() was called
        float withRay, alone;    ///< weights of the strategies of s >= 2, of s = 1
        float pdfPoint, pdfRay;  ///< when it was found, relative to plain emission
    };

    /// Adds a path that bidirectional path tracing made with `lights`, with its weighted
    /// contribution (mean of the channels). Paths that no light subpath makes are left out.
    void add(FullPath& path, const TechniqueCounts& counts, const Lights& lights,
             float contribution, std::uint32_t pixel);
    void append(const EmissionSamples& other, std::size_t index) { put(other.samples_[index]); }
    void put(const Sample& sample) { samples_.push_back(sample); }
    /// Divides contributions by what their pixels show.
    void relate(const PixelScale& scale);
    /// The outlierLimit() of the contributions (relative_contribution.h).
    float outlierLimit() const;
    /// Lowers larger contributions to the limit.
    void lowerTo(float limit);

    std::size_t size() const { return samples_.size(); }
    std::uint32_t pixel(std::size_t index) const { return samples_[index].pixel; }
    std::span<const Sample> samples() const { return samples_; }

  private:
    std::vector<Sample> samples_;
};

/// The second moment of a sample's contribution if its point and its ray had the density of plain
/// emission: for the strategies that draw both, and for those that draw the point alone.
struct PlainMoments {
    double withRay, alone;
};
PlainMoments plainMoments(const EmissionSamples::Sample& sample);

}  // namespace lacuna

// Layers that show what a method's distributions did: the share of each in the picture.
#pragma once

#include <string>
#include <vector>

#include "libcore/bidir/integrator.h"
#include "libcore/image/image.h"

namespace lacuna {

/// Contributions of connections by the label of their proposal, weighted by MIS.
class ProposalLayers final : public BlockLayers {
  public:
    /// `names`: of the labels.
    ProposalLayers(std::vector<std::string> names, int width, int height);

    /// Different pixels may be added to at the same time. What no connection made is left out.
    void add(const PathEvent& event);
    void countIteration() { ++iterations_; }
    /// Layers part.NAME.
    Layers means() const override;
    void clear() override;

  private:
    std::vector<std::string> names_;
    int width_, height_;
    std::vector<std::vector<Rgb>> sums_;  // by name
    std::uint64_t iterations_ = 0;
};

}  // namespace lacuna

// Layers that show how much each proposal distribution of a method contributes to the picture.
#pragma once

#include <string>
#include <vector>

#include "libcore/bidir/integrator.h"
#include "libcore/image/image.h"

namespace lacuna {

/// Sums of the MIS-weighted contributions of connections, by the label of their proposal.
class ProposalLayers final : public BlockLayers {
  public:
    /// `names`: names of the labels.
    ProposalLayers(std::vector<std::string> names, int width, int height);

    /// Adds a contribution, unless no connection made it. Threads may add to different pixels at
    /// the same time.
    void add(const PathEvent& event);
    void countIteration() { ++iterations_; }
    /// The layers part.NAME.
    Layers means() const override;
    void clear() override;

  private:
    std::vector<std::string> names_;
    int width_, height_;
    std::vector<std::vector<Rgb>> sums_;  // by name
    std::uint64_t iterations_ = 0;
};

}  // namespace lacuna

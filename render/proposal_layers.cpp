#include "render/proposal_layers.h"

#include <algorithm>

namespace lacuna {

ProposalLayers::ProposalLayers(std::vector<std::string> names, int width, int height)
    : names_(std::move(names)),
      width_(width),
      height_(height),
      sums_(names_.size(), std::vector<Rgb>(std::size_t(width) * std::size_t(height))) {}

void ProposalLayers::add(const PathEvent& event) {
    if (!event.proposal || event.proposal->label >= sums_.size()) return;
    if (isFinite(event.contribution))
        sums_[event.proposal->label][event.pixel] += event.contribution;
}

Layers ProposalLayers::means() const {
    LayeredImage image(width_, height_);
    for (std::size_t label = 0; label < names_.size(); ++label) {
        image.setRgb("part." + names_[label],
                     meanOfSum(sums_[label], iterations_, width_, height_));
    }
    return image.channels();
}

void ProposalLayers::clear() {
    for (std::vector<Rgb>& sum : sums_) std::ranges::fill(sum, Rgb{});
    iterations_ = 0;
}

}  // namespace lacuna

// A pair of pictures per technique (s, t).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/bidir/film.h"

namespace lacuna {

/// Summed over a block's iterations: --techniques.
class TechniqueFilm final : public BlockLayers {
  public:
    TechniqueFilm(int width, int height, int maxDepth);

    /// "s02t03"
    static std::string layerName(int s, int t);
    /// Adds to one pixel; different pixels may be added to at the same time.
    void add(int s, int t, std::uint32_t pixel, const Rgb& weighted, const Rgb& unweighted);
    void countIteration() { ++iterations_; }
    /// Layers weighted.sSStTT and unweighted.sSStTT, of techniques that contributed.
    Layers means() const override;
    void clear() override;
    Image weighted(int s, int t) const { return mean(s, t, false); }
    Image unweighted(int s, int t) const { return mean(s, t, true); }

  private:
    std::size_t indexOf(int s, int t) const;
    Image mean(int s, int t, bool unweighted) const;

    int width_, height_, maxDepth_;
    std::uint64_t iterations_ = 0;
    std::vector<std::vector<Rgb>> layers_;  // [technique * 2 + unweighted]
};

/// The channel share.t02 from the layers weighted.sSStTT of paths of up to `maxDepth` edges: what
/// connections of the first eye vertex (t = 2, s > 0) add to the pixel's mean over the channels, as
/// a share of it [Nabata20a fig 2]; 0 where it is black.
void addShareOfFirstConnections(LayeredImage& image, int maxDepth);

}  // namespace lacuna

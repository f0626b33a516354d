// Layers that show what a method did: the share of each of its distributions, and the skeleton node
// or the eye subspace that visible surfaces belong to.
#pragma once

#include <string>
#include <vector>

#include "libcore/bidir/integrator.h"
#include "libcore/skeleton/node_map.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna {

/// Contributions of connections by the label of their proposal, weighted by MIS.
class PartFilm {
  public:
    PartFilm(std::vector<std::string> names, int width, int height);

    /// Different pixels may be added to at the same time. What no connection made is left out.
    void add(const PathEvent& event);
    /// Layers part.NAME, means over the iterations.
    void writeTo(LayeredImage& image, std::uint64_t iterations) const;

  private:
    std::vector<std::string> names_;
    int width_, height_;
    std::vector<std::vector<Rgb>> sums_;  // by name
};

/// A colour of its own for the node of what the middle of each pixel of `crop` shows; black where
/// there is no node.
Image nodeLayer(const Scene& scene, const Camera& camera, const PixelRect& crop,
                const Skeleton& skeleton, const ThreadPool& pool);

/// Likewise for the eye subspace, as seen from the camera [Su22 fig 7].
Image subspaceLayer(const Scene& scene, const Camera& camera, const PixelRect& crop,
                    const Subspaces& subspaces, const ThreadPool& pool);

/// Likewise for the light subspace that Gamma picks most often there.
Image lightSubspaceLayer(const Scene& scene, const Camera& camera, const PixelRect& crop,
                         const Subspaces& subspaces, const ThreadPool& pool);

}  // namespace lacuna

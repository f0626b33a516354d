// Boxes around smooth and nearly smooth glass, so that rays which could not meet any need not be traced. (theory.md,
// "Next event through glass")
#pragma once

#include <span>
#include <vector>

#include "libcore/scene/scene.h"
#include "libcore/specular/boxes.h"

namespace lacuna {

/// At most 32 boxes around the triangles of all instances whose material is such glass and stops all rays.
std::vector<BoxedTriangles> glassInBoxes(const Scene& scene);
/// Likewise for nearly smooth glass alone.
std::vector<BoxedTriangles> facetsInBoxes(const Scene& scene);

/// How much wider boxes are than their triangles, in scene units: rays leave surfaces by an offset.
float boxMargin(const Scene& scene);

class GlassBoxes {
  public:
    /// `glass` is glassInBoxes().
    explicit GlassBoxes(std::span<const BoxedTriangles> glass);

    /// Whether the straight way from `origin` along `way` may meet glass: as far as `way` is long, or without end.
    /// Never false where it does.
    bool mayLieOn(const Vec3& origin, const Vec3& way, bool forEver) const;

  private:
    std::vector<Box> boxes_;
    Box whole_{};  ///< around all of them
};

}  // namespace lacuna

// Where there is smooth glass, so that rays which could not meet any need not be traced.
#pragma once

#include <vector>

#include "libcore/scene/scene.h"

namespace lacuna {

class GlassBoxes {
  public:
    /// Boxes around the triangles of all instances whose material is smooth glass that stops
    /// all rays.
    explicit GlassBoxes(const Scene& scene);

    bool empty() const { return boxes_.empty(); }
    /// Whether the straight way from `origin` along `way` may meet glass: as far as `way` is long, or
    /// for ever. Never false where it does.
    bool mayLieOn(const Vec3& origin, const Vec3& way, bool forEver) const;

  private:
    struct Box {
        Vec3 low, high;
    };
    Box whole_;  ///< around all of them
    std::vector<Box> boxes_;
};

}  // namespace lacuna

// What next event through glass knows of a scene's smooth glass: made once for all renders of it.
// (theory.md, "Next event through glass")
#pragma once

#include "libcore/specular/glass_bodies.h"
#include "libcore/specular/glass_boxes.h"
#include "libcore/specular/glass_shadows.h"

namespace lacuna {

class SmoothGlass {
  public:
    /// A function of the scene.
    explicit SmoothGlass(const Scene& scene) : SmoothGlass(scene, glassInBoxes(scene)) {}

    /// The scene has no lamp with a size and no sky, or no smooth glass.
    bool empty() const { return shadows_.empty(); }

    const GlassBoxes& boxes() const { return boxes_; }
    const GlassShadows& shadows() const { return shadows_; }
    const GlassBodies& bodies() const { return bodies_; }

  private:
    SmoothGlass(const Scene& scene, std::span<const BoxedTriangles> glass)
        : boxes_(glass),
          shadows_(scene, glass),
          bodies_(shadows_.empty() ? GlassBodies() : GlassBodies(scene)) {}

    GlassBoxes boxes_;
    GlassShadows shadows_;
    GlassBodies bodies_;
};

}  // namespace lacuna

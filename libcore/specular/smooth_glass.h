// The tables of a scene's smooth and nearly smooth glass for next event through glass. They are made once for all
// renders of the scene. (theory.md, "Next event through glass")
#pragma once

#include "libcore/specular/glass_bodies.h"
#include "libcore/specular/glass_boxes.h"
#include "libcore/specular/glass_shadows.h"

namespace lacuna {

class SmoothGlass {
  public:
    /// A function of the scene.
    explicit SmoothGlass(const Scene& scene)
        : SmoothGlass(scene, glassInBoxes(scene), facetsInBoxes(scene)) {}

    /// Whether the scene has no such glass, or no light that next event joins through it.
    bool empty() const { return shadows_.empty(); }
    /// Whether some of it is nearly smooth, so that facets refract there (mayBeNarrowGlass).
    bool hasFacets() const { return hasFacets_; }

    const GlassBoxes& boxes() const { return boxes_; }
    const GlassShadows& shadows() const { return shadows_; }
    const GlassBodies& bodies() const { return bodies_; }

  private:
    SmoothGlass(const Scene& scene, std::span<const BoxedTriangles> glass,
                std::span<const BoxedTriangles> facets)
        : boxes_(glass),
          shadows_(scene, glass, facets),
          bodies_(shadows_.empty() ? GlassBodies() : GlassBodies(scene)),
          hasFacets_(!facets.empty()) {}

    GlassBoxes boxes_;
    GlassShadows shadows_;
    GlassBodies bodies_;
    bool hasFacets_;
};

}  // namespace lacuna

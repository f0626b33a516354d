// Estimates how often techniques behind glass pay in a view: next event through glass, next event along known ways and
// the search for specular chains. Small pictures are rendered for it before the render, and their samples are thrown
// away. This is no row; it lies in this folder because the rows pt and bpt render the
// pictures. (theory.md, "Effort behind glass")
#pragma once

#include "libcore/bidir/render_setup.h"

namespace lacuna {

/// Renders with pt and one of these techniques (chains: with bpt where `techniques` splat), at no more than 4096 pixels
/// of the whole film. The result is a function of the scene, the camera, the techniques and `settings`, but not of its
/// seed, crop, sampling, number of light paths and background. An effort is 1 where `techniques` do not have the
/// technique, or the scene has nothing for it.
GlassEffort glassEffortFor(const Scene& scene, const Camera& camera, const Techniques& techniques,
                           const RenderSettings& settings, const ThreadPool& threads);

}  // namespace lacuna

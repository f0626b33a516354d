// How often next event through glass and along known ways pays in a view, and the search for specular chains: by small
// pictures before the render, whose samples are thrown away. (theory.md, "Effort behind glass")
#pragma once

#include "libcore/bidir/render_setup.h"

namespace lacuna {

/// By path tracing with each (chains: by bpt where `techniques` splat), at no more than 4096 pixels of the whole film.
/// A function of the scene, the camera, the techniques and `settings`, but for its seed, crop, sampling, number of light
/// paths and background. 1 for what the techniques do not hold, or the scene has not.
GlassEffort glassEffortFor(const Scene& scene, const Camera& camera, const Techniques& techniques,
                           const RenderSettings& settings, const ThreadPool& threads);

}  // namespace lacuna

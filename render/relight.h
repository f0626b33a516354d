// Changes intensities and colours of the lamps in a picture with a layer for each light group.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "libcore/image/image.h"

namespace lacuna {

/// The factors of a group's light: R, G, B; finite and not below 0.
using LightFactor = std::array<double, 3>;
/// Factors by name of the group.
using LightFactors = std::map<std::string, LightFactor>;

/// Parses "sun=0.1" or "lamps=2,1.8,1" and adds it to `factors`. Throws UsageError, whose message begins with `option`,
/// also for a group that has a factor already.
void addLightFactor(LightFactors& factors, const std::string& option, const std::string& text);

/// The groups with layers, in the order of their covariances; empty if the header names none.
/// Throws InputError, which names the file `path`, if the header is damaged or a layer is missing.
std::vector<std::string> lightGroupsOf(const LayeredImage& image, const std::string& path);

/// The picture under changed light: the sum of the groups' layers, each times its factor. Groups without a factor stay
/// as they are. The variance is kept if it is known, from the covariances of --light-noise or because all factors are
/// equal. Layers and attributes that depend on the old light are left out. The attribute `relit` holds the factors.
///
/// Throws InputError, which names the file `path`, if the image has no groups; UsageError for an unknown group or if a
/// pixel becomes too bright for a float.
LayeredImage relight(const LayeredImage& image, const LightFactors& factors,
                     const std::string& path);

}  // namespace lacuna

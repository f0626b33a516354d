// New intensities and colours for the lamps of a picture that has a layer for each group of lights.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "libcore/image/image.h"

namespace lacuna {

/// What the light of a group is multiplied by: R, G, B; finite, none below 0.
using LightFactor = std::array<double, 3>;
/// By group.
using LightFactors = std::map<std::string, LightFactor>;

/// "sun=0.1", "lamps=2,1.8,1", added to `factors`. `option` begins the error. Throws UsageError, for a
/// group that is there already as well.
void addLightFactor(LightFactors& factors, const std::string& option, const std::string& text);

/// The groups that have layers, in the order of their covariances; none where the header names none.
/// Throws InputError where the header is damaged or a layer is missing; `path` is the file's.
std::vector<std::string> lightGroupsOf(const LayeredImage& image, const std::string& path);

/// The picture under other light: each group's layer times its factor, and their sum. Groups without a
/// factor stay as they are. The variance is kept where it is known: from the covariances of
/// --light-noise, or where all factors are the same. Layers and attributes are left out that are of the
/// other light; the attribute `relit` says by what each group was multiplied.
///
/// Throws InputError where the image has no groups (`path` is the file's), UsageError for a group that
/// it does not have or a pixel that is too bright for a float.
LayeredImage relight(const LayeredImage& image, const LightFactors& factors,
                     const std::string& path);

}  // namespace lacuna

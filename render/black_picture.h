// What to say of a picture that is black although the scene has lights.
#pragma once

#include <string>

#include "libcore/methods/registry.h"
#include "render/stage.h"

namespace lacuna {

/// The causes that experiments with the scene bear out (small renders by bpt, light and eye paths
/// traced by themselves), and what was found where they bear out none. Takes about a second.
std::string whyBlack(const Stage& stage, const MethodRow& method, const ThreadPool& pool);

}  // namespace lacuna

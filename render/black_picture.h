// Diagnosis of a picture that is black although the scene has lights.
#pragma once

#include <string>

#include "libcore/methods/registry.h"
#include "render/stage.h"

namespace lacuna {

/// The causes that experiments with the scene confirm: small renders by bpt, and separately traced
/// light and eye paths. If they confirm none, the text reports what they found. Takes about a
/// second.
std::string whyBlack(const Stage& stage, const MethodRow& method, const ThreadPool& pool);

}  // namespace lacuna

// The first visible surfaces: their feature layers, and the error meter that uses them.
#pragma once

#include "libcore/bidir/error_estimate.h"
#include "libcore/bidir/features.h"
#include "render/stage.h"

namespace lacuna {

struct FirstLook {
    /// Measures its time as the stage's phase "features". Throws InterruptedError if it is not done three
    /// seconds after `interrupted` became true (Grace).
    FirstLook(Stage& stage, const ThreadPool& pool, const std::atomic<bool>& interrupted);

    FeatureLayers features;
    ErrorMeter meter;
};

}  // namespace lacuna

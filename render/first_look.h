// What the lens sees first: layers of the picture, and what its error is measured by.
#pragma once

#include "libcore/bidir/error_estimate.h"
#include "libcore/bidir/features.h"
#include "render/stage.h"

namespace lacuna {

struct FirstLook {
    /// Times itself as the stage's phase "features".
    FirstLook(Stage& stage, const ThreadPool& pool);

    FeatureLayers features;
    ErrorMeter meter;
};

}  // namespace lacuna

// What a render made.
#pragma once

#include <string>

#include "libcore/base/error.h"
#include "libcore/image/image.h"
#include "render/output.h"

namespace lacuna {

struct Rendered {
    RenderReport report;
    LayeredImage image;   ///< empty for --estimate
    std::string text;     ///< for stdout: what was written, or what accuracy costs
    std::string failure;  ///< of a log, a checkpoint: the picture is there all the same

    bool interrupted() const { return report.stopped == "interrupt"; }
    int exitCode() const { return interrupted() ? kInterruptedExit : 0; }
};

}  // namespace lacuna

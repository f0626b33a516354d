// The result of a render.
#pragma once

#include <string>

#include "libcore/base/error.h"
#include "libcore/image/image.h"
#include "render/output.h"

namespace lacuna {

struct Rendered {
    RenderReport report;
    LayeredImage image;   ///< empty for --estimate
    std::string text;     ///< for stdout: the files written, or the result of --estimate
    std::string failure;  ///< of a log or checkpoint; the picture exists nevertheless

    bool interrupted() const { return report.stopped == "interrupt"; }
    int exitCode() const { return interrupted() ? kInterruptedExit : 0; }
};

}  // namespace lacuna

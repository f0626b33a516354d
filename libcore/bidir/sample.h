// The name of a sample, by which it can be drawn again alone.
#pragma once

#include <cstdint>
#include <string>

namespace lacuna {

/// Which of a render's samples a path comes from.
struct Sample {
    std::uint32_t iteration = 0;
    bool ofLight = false;      ///< a light subpath (t = 1), else an eye path
    std::uint64_t number = 0;  ///< of the light subpath; of the pixel, row-major in the full film

    /// "x,y,iteration" or "light:NUMBER,iteration": what --replay takes.
    std::string address(int filmWidth) const;
};

}  // namespace lacuna

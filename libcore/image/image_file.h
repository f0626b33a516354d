// A picture's file whose pixels are still to be decoded.
#pragma once

#include <functional>

#include "libcore/image/image.h"

namespace lacuna {

/// What its header says is checked: nothing of the picture's size is allocated before `decode`.
struct ImageFile {
    ImageSize size;
    std::function<Image()> decode;  ///< of that size; throws InputError
};

}  // namespace lacuna

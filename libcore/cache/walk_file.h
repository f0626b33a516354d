// KEY.walks: the learned distributions of directions of walks. A section file (section_file.h;
// files.md, "Walks").
#pragma once

#include <memory>

#include "libcore/bidir/walk_guide.h"
#include "libcore/cache/cache_name.h"

namespace lacuna {

struct WalkFile {
    std::shared_ptr<const WalkGuide> guide;  ///< null: nothing beats sampling the BSDFs
    CacheStamp stamp;
    std::string contentHash;
};

/// Writes the file atomically. Throws RunError.
void writeWalkFile(const std::string& path, const WalkFile& file);

/// Throws InputError if the file is missing, damaged, of another version, or made of other inputs
/// than `expected` names; `remedy` tells the user what to do.
WalkFile readWalkFile(const std::string& path, const CacheStamp& expected,
                      const std::string& remedy);

}  // namespace lacuna

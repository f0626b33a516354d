// KEY.walks: where walks go on to. A section file (section_file.h; files.md, "Walks").
#pragma once

#include <memory>

#include "libcore/bidir/walk_guide.h"
#include "libcore/cache/cache_name.h"

namespace lacuna {

struct WalkFile {
    std::shared_ptr<const WalkGuide> guide;  ///< null: nothing is better than BSDFs
    CacheStamp stamp;
    std::string contentHash;
};

/// Atomically. Throws RunError.
void writeWalkFile(const std::string& path, const WalkFile& file);

/// Throws InputError if the file is missing, damaged, of another version, or made of other inputs
/// than `expected` names; `remedy` says what to do.
WalkFile readWalkFile(const std::string& path, const CacheStamp& expected,
                      const std::string& remedy);

}  // namespace lacuna

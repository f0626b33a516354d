// KEY.emission: where light subpaths begin and set out. A section file (section_file.h; files.md,
// "Emission").
#pragma once

#include <memory>

#include "libcore/cache/cache_name.h"
#include "libcore/scene/emission_guide.h"

namespace lacuna {

struct EmissionFile {
    std::shared_ptr<const EmissionGuide> guide;  ///< null: nothing is better than plain emission
    CacheStamp stamp;
    std::string contentHash;
};

/// Atomically. Throws RunError.
void writeEmissionFile(const std::string& path, const EmissionFile& file);

/// Throws InputError if the file is missing, damaged, of another version, or made of other inputs
/// than `expected` names; `remedy` says what to do. Whether the guide fits a scene's lights is
/// still to be asked (EmissionGuide::check).
EmissionFile readEmissionFile(const std::string& path, const CacheStamp& expected,
                              const std::string& remedy);

}  // namespace lacuna

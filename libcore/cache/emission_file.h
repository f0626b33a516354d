// KEY.emission: the learned distribution of emission, from which light subpaths begin. A section
// file (section_file.h; files.md, "Emission").
#pragma once

#include <memory>

#include "libcore/cache/cache_name.h"
#include "libcore/scene/emission_guide.h"

namespace lacuna {

struct EmissionFile {
    std::shared_ptr<const EmissionGuide> guide;  ///< null: nothing beats plain emission
    CacheStamp stamp;
    std::string contentHash;
};

/// Writes the file atomically. Throws RunError.
void writeEmissionFile(const std::string& path, const EmissionFile& file);

/// Throws InputError if the file is missing, damaged, of another version, or made of other inputs
/// than `expected` names; `remedy` tells the user what to do. The caller still has to check whether
/// the guide fits the scene's lights (EmissionGuide::check).
EmissionFile readEmissionFile(const std::string& path, const CacheStamp& expected,
                              const std::string& remedy);

}  // namespace lacuna

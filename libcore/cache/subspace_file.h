// KEY.subspaces, which lacuna-train writes and lacuna-render reads. A section file (section_file.h;
// files.md, "Subspaces"); the table in the .cpp gives the order of its sections and their element
// types. Every size, index and number is checked before it is used.
#pragma once

#include "libcore/cache/cache_name.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna {

struct SubspaceFile {
    Subspaces subspaces;
    CacheStamp stamp;
    std::string contentHash;
};

/// Writes the file atomically. Throws RunError.
void writeSubspaceFile(const std::string& path, const SubspaceFile& file);

/// Throws InputError if the file is missing, damaged, of another version, or made of other inputs
/// than `expected` names; `remedy` tells the user what to do.
SubspaceFile readSubspaceFile(const std::string& path, const CacheStamp& expected,
                              const std::string& remedy);

}  // namespace lacuna

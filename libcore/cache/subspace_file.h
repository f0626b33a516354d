// KEY.subspaces: what lacuna-train writes and lacuna-render reads. One section file (section_file.h;
// files.md, "Subspaces"), its sections in the order and with the element sizes of the table in the
// .cpp. Every size, index and number is compared before it is used.
#pragma once

#include "libcore/cache/cache_name.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna {

struct SubspaceFile {
    Subspaces subspaces;
    CacheStamp stamp;
    std::string contentHash;
};

/// Atomically. Throws RunError.
void writeSubspaceFile(const std::string& path, const SubspaceFile& file);

/// Throws InputError if the file is missing, damaged, of another version, or made of other inputs
/// than `expected` names; `remedy` says what to do.
SubspaceFile readSubspaceFile(const std::string& path, const CacheStamp& expected,
                              const std::string& remedy);

}  // namespace lacuna

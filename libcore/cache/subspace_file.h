// KEY.subspaces: what lacuna-train writes and lacuna-render reads. One file (files.md,
// "Subspaces"):
//
//   64 bytes   magic, version, number of sections, bytes in all, XXH3-128 of everything else
//   sections   name (16 bytes), bytes per element, number of elements, elements, zeros up to a
//              multiple of 8; in the order and with the element sizes of the table in the .cpp
//
// Little-endian, as it lies in memory. Length, checksum and version are compared before anything
// else is read; then every size, index and number is.
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

#include <algorithm>
#include <cstring>
#include <vector>

#include "libcore/base/content_hash.h"
#include "libcore/cache/emission_file.h"
#include "libcore/cache/guarded_file.h"
#include "libcore/cache/subspace_file.h"
#include "libcore/cache/walk_file.h"
#include "tests/cache/example_subspaces.h"
#include "tests/fuzz/attempt.h"

namespace lacuna::test {
namespace {

constexpr const char* kRemedy = "make it again";

/// A file of sections (section_file.h) with the length and the checksum that it should have.
std::string repaired(Bytes bytes) {
    std::vector<std::uint8_t> all(bytes.begin(), bytes.end());
    if (all.size() >= 64) {
        const std::uint64_t size = all.size();
        std::memcpy(all.data() + 16, &size, sizeof size);
        std::fill_n(all.begin() + 24, 16, std::uint8_t(0));
        ContentHash hash;
        hash.addValues(Bytes(all));
        const auto digest = hash.digest();
        std::memcpy(all.data() + 24, digest.data(), sizeof digest);
    }
    return fileOf("cache", all);
}

}  // namespace

bool acceptsSubspaces(Bytes bytes) {
    return attempt([&] { readSubspaceFile(repaired(bytes), kStamp, kRemedy); });
}

bool acceptsEmission(Bytes bytes) {
    return attempt([&] { readEmissionFile(repaired(bytes), kStamp, kRemedy); });
}

bool acceptsWalks(Bytes bytes) {
    return attempt([&] { readWalkFile(repaired(bytes), kStamp, kRemedy); });
}

bool acceptsGuarded(Bytes bytes) {
    // The sidecar, a zero, the file.
    const auto zero = std::find(bytes.begin(), bytes.end(), std::uint8_t(0));
    const auto sidecar = bytes.first(std::size_t(zero - bytes.begin()));
    fileOf("a.vdb.xxh3", sidecar);
    const std::string path =
        fileOf("a.vdb", bytes.subspan(std::min(sidecar.size() + 1, bytes.size())));
    return attempt([&] { readGuarded(path, kRemedy); });
}

}  // namespace lacuna::test

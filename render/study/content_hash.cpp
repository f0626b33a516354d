#include "render/study/content_hash.h"

#include <xxhash.h>

#include <cstdio>

#include "libcore/image/file_bytes.h"

namespace lacuna {

std::string contentHash(std::string_view bytes) {
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    char hex[33];
    std::snprintf(hex, sizeof hex, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                  static_cast<unsigned long long>(hash.low64));
    return hex;
}

std::string fileHash(const std::string& path) {
    const std::vector<std::uint8_t> bytes = readFileBytes(path);
    return contentHash({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace lacuna

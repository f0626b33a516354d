#include "render/study/content_hash.h"

#include "libcore/base/content_hash.h"
#include "libcore/image/file_bytes.h"

namespace lacuna {

std::string contentHash(std::string_view bytes) {
    ContentHash hash;
    hash.addValues(std::span(bytes));
    return hash.hex();
}

std::string fileHash(const std::string& path) {
    const std::vector<std::uint8_t> bytes = readFileBytes(path);
    return contentHash({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace lacuna

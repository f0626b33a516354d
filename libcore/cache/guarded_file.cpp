#include "libcore/cache/guarded_file.h"

#include <fstream>
#include <sstream>

#include "libcore/base/atomic_file.h"
#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"

namespace lacuna {

namespace {

std::string sidecarText(std::string_view bytes) {
    ContentHash hash;
    hash.addValues(std::span(bytes));
    return "lacuna-guard 1\nbytes " + std::to_string(bytes.size()) + "\nxxh3-128 " + hash.hex() +
           "\n";
}

bool readAll(const std::string& path, std::string& bytes) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream content;
    // An empty file sets failbit on `content`: only the source tells whether it could be read.
    if (!file.is_open()) return false;
    content << file.rdbuf();
    bytes = std::move(content).str();
    return !file.bad();
}

}  // namespace

void writeGuarded(const std::string& path, std::string_view bytes) {
    writeFileAtomically(path, bytes);
    writeFileAtomically(path + ".xxh3", sidecarText(bytes));
}

std::string readGuarded(const std::string& path, const std::string& remedy) {
    std::string bytes, sidecar;
    if (!readAll(path, bytes)) {
        throw InputError(path + ": expected a cache, found no such file; " + remedy);
    }
    if (!readAll(path + ".xxh3", sidecar)) {
        throw InputError(path + ".xxh3: expected the checksum beside the cache, found none; " +
                         remedy);
    }
    if (sidecar != sidecarText(bytes)) {
        throw InputError(path + ": expected what its checksum says, found other bytes; " + remedy);
    }
    return bytes;
}

}  // namespace lacuna

#include "libcore/base/content_hash.h"

#include <xxhash.h>

#include <fstream>
#include <istream>
#include <new>
#include <vector>

#include "libcore/base/error.h"

namespace lacuna {

struct ContentHash::State {
    XXH3_state_t* xxh = XXH3_createState();
    ~State() { XXH3_freeState(xxh); }
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {
    if (!state_->xxh) throw std::bad_alloc();
    XXH3_128bits_reset(state_->xxh);
}

ContentHash::~ContentHash() = default;

void ContentHash::add(std::span<const std::byte> bytes) {
    if (!bytes.empty()) XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
}

void ContentHash::addStream(std::istream& stream) {
    std::vector<char> block(1u << 20);
    while (stream) {
        stream.read(block.data(), std::streamsize(block.size()));
        addValues(std::span<const char>(block.data(), std::size_t(stream.gcount())));
    }
}

std::array<std::uint64_t, 2> ContentHash::digest() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
    return {hash.low64, hash.high64};
}

std::string ContentHash::hex() const {
    const auto [low, high] = digest();
    std::string text;
    for (const std::uint64_t half : {high, low}) {
        for (int shift = 60; shift >= 0; shift -= 4) {
            text += "0123456789abcdef"[(half >> shift) & 15u];
        }
    }
    return text;
}

std::string hashOfFile(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    ContentHash hash;
    hash.addStream(stream);
    if (!stream.eof()) {
        throw InputError(path + ": expected a file that can be read, found none; check the name");
    }
    return hash.hex();
}

}  // namespace lacuna

#include "libcore/cache/section_file.h"

#include <array>
#include <fstream>
#include <sstream>

#include "libcore/base/atomic_file.h"
#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"

namespace lacuna {

namespace {

struct Header {
    char magic[8];
    std::uint32_t version, sections;
    std::uint64_t bytes;  // of the file
    std::uint64_t hash[2];
    std::uint64_t reserved[3];
};
static_assert(sizeof(Header) == 64);

struct Section {
    char name[16];
    std::uint64_t elementBytes, count;
};
static_assert(sizeof(Section) == 32);

std::size_t padded(std::size_t bytes) {
    return (bytes + 7) / 8 * 8;
}

/// Hash of everything but the hash itself.
std::array<std::uint64_t, 2> hashOf(Header header, const std::string& bytes) {
    header.hash[0] = header.hash[1] = 0;
    ContentHash hash;
    hash.addValue(header);
    hash.addValues(std::span(bytes).subspan(sizeof(header)));
    return hash.digest();
}

}  // namespace

void SectionWriter::add(const char* name, std::size_t elementBytes, std::size_t count,
                        const void* data) {
    Section s{};
    std::strncpy(s.name, name, sizeof(s.name) - 1);
    s.elementBytes = elementBytes;
    s.count = count;
    bytes_.append(reinterpret_cast<const char*>(&s), sizeof(s));
    bytes_.append(static_cast<const char*>(data), elementBytes * count);
    bytes_.resize(padded(bytes_.size()), '\0');
}

void SectionWriter::write(const std::string& path, const SectionFormat& format) {
    Header header{};
    std::memcpy(header.magic, format.magic, sizeof(header.magic));
    header.version = format.version;
    header.sections = format.sections;
    header.bytes = bytes_.size();
    const auto hash = hashOf(header, bytes_);
    header.hash[0] = hash[0];
    header.hash[1] = hash[1];
    std::memcpy(bytes_.data(), &header, sizeof(header));
    writeFileAtomically(path, bytes_);
}

SectionReader::SectionReader(const std::string& path, const SectionFormat& format,
                             const std::string& remedy) {
    const auto refuse = [&](const std::string& what, const std::string& found) {
        throw InputError(path + ": expected " + what + ", found " + found + "; " + remedy);
    };
    {
        std::ifstream in(path, std::ios::binary);
        if (!in.is_open()) refuse("a cache", "no such file");
        std::ostringstream content;
        content << in.rdbuf();
        bytes_ = std::move(content).str();
    }
    Header header{};
    if (bytes_.size() >= sizeof(header)) std::memcpy(&header, bytes_.data(), sizeof(header));
    if (std::memcmp(header.magic, format.magic, sizeof(header.magic)) != 0) {
        refuse(std::string(format.holds) + " written by " + format.writer, "another file");
    }
    if (header.version != format.version) {
        refuse("format " + std::to_string(format.version), std::to_string(header.version));
    }
    const auto hash = hashOf(header, bytes_);
    if (header.bytes != bytes_.size() || header.sections != format.sections ||
        header.hash[0] != hash[0] || header.hash[1] != hash[1]) {
        refuse("what its checksum says", "other bytes");
    }
}

std::span<const char> SectionReader::next(const char* name, std::size_t elementBytes) {
    const auto require = [&](bool good) {
        if (!good) throw std::invalid_argument(std::string("section ") + name);
    };
    require(bytes_.size() - at_ >= sizeof(Section));
    Section s;
    std::memcpy(&s, bytes_.data() + at_, sizeof(s));
    at_ += sizeof(s);
    char expected[sizeof(s.name)] = {};
    std::strncpy(expected, name, sizeof(expected) - 1);
    require(std::memcmp(s.name, expected, sizeof(expected)) == 0);
    require(s.elementBytes == elementBytes);
    require(s.count <= (bytes_.size() - at_) / s.elementBytes);
    const std::size_t size = s.count * s.elementBytes;
    const std::span<const char> found(bytes_.data() + at_, size);
    require(padded(at_ + size) <= bytes_.size());
    at_ = padded(at_ + size);
    return found;
}

}  // namespace lacuna

// Binary files of named arrays, the format of caches:
//
//   64 bytes magic, version, number of sections, total bytes, XXH3-128 of everything else
//   sections   name (16 bytes), bytes per element, number of elements, elements, zeros up to a
//              multiple of 8
//
// Little-endian, as in memory. Length, checksum and version are compared before anything else is
// read; then every size is.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna {

struct SectionFormat {
    char magic[8];
    std::uint32_t version, sections;
    const char* holds;   ///< "subspaces"
    const char* writer;  ///< "lacuna-train"
};

/// Takes sections in the order of the file. The schema visits the same sections when it reads.
class SectionWriter {
  public:
    template <class Array>
    void operator()(const char* name, const Array& values) {
        add(name, sizeof(values[0]), values.size(), values.data());
    }
    /// Writes the file atomically. Throws RunError.
    void write(const std::string& path, const SectionFormat& format);

  private:
    void add(const char* name, std::size_t elementBytes, std::size_t count, const void* data);

    std::string bytes_ = std::string(64, '\0');  // begins with room for the header
};

class SectionReader {
  public:
    /// Throws InputError if the file is missing, damaged or of another format; `remedy` tells the
    /// user what to do.
    SectionReader(const std::string& path, const SectionFormat& format, const std::string& remedy);

    /// Reads the next section. Throws std::invalid_argument if it has another name or size of
    /// elements.
    template <class Array>
    void operator()(const char* name, Array& values) {
        const std::span<const char> bytes = next(name, sizeof(values[0]));
        values.resize(bytes.size() / sizeof(values[0]));
        if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    }

  private:
    std::span<const char> next(const char* name, std::size_t elementBytes);

    std::string bytes_;
    std::size_t at_ = 64;
};

}  // namespace lacuna

#include "libcore/gltf/files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <system_error>
#include <vector>

#include "libcore/gltf/limits.h"
#include "libcore/gltf/report.h"

namespace lacuna::gltf {
namespace fs = std::filesystem;
namespace {

/// Size of the regular file `path`. Refuses anything else, so that the reader never waits on a pipe
/// or reads from a device.
std::uint64_t regularFileSize(const fs::path& path, const std::string& by) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) {
        refuse(path.string(), "", "a file" + by, "none", "check the name");
    }
    if (status.type() == fs::file_type::directory) {
        refuse(path.string(), "", "a file" + by, "a directory", "name the file in it");
    }
    if (status.type() != fs::file_type::regular) {
        refuse(path.string(), "", "a regular file" + by, error ? error.message() : "something else",
               "copy it to a file");
    }
    const std::uint64_t size = fs::file_size(path, error);
    if (error) refuse(path.string(), "", "a file" + by, error.message(), "check its permissions");
    return size;
}

std::ifstream openFile(const fs::path& path, const std::string& by) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) {
        refuse(path.string(), "", "a readable file" + by, "one that cannot be opened",
               "check its permissions");
    }
    return stream;
}

std::string byClause(const std::string& askedBy) {
    return askedBy.empty() ? "" : " (named by " + askedBy + ")";
}

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// Whether an RFC 3986 scheme precedes the first colon. A Windows drive letter counts as one.
bool hasScheme(std::string_view uri) {
    const std::size_t colon = uri.find(':');
    if (colon == std::string_view::npos || colon == 0) return false;
    return std::all_of(uri.begin(), uri.begin() + std::ptrdiff_t(colon), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '-' || c == '.';
    });
}

bool leavesFolder(std::string_view name) {
    std::size_t begin = 0;
    while (begin <= name.size()) {
        const std::size_t end = std::min(name.find_first_of("/\\", begin), name.size());
        if (name.substr(begin, end - begin) == "..") return true;
        begin = end + 1;
    }
    return false;
}

}  // namespace

Bytes readFile(const fs::path& path, std::uint64_t mostBytes, const std::string& askedBy) {
    const std::string by = byClause(askedBy);
    const std::uint64_t size = regularFileSize(path, by);
    if (size > mostBytes) {
        refuse(path.string(), "", "at most " + std::to_string(mostBytes) + " bytes" + by,
               std::to_string(size), "split or simplify the scene");
    }
    std::ifstream stream = openFile(path, by);
    Bytes bytes{std::make_unique_for_overwrite<std::uint8_t[]>(size), std::size_t(size)};
    stream.read(reinterpret_cast<char*>(bytes.data.get()), std::streamsize(size));
    if (std::uint64_t(stream.gcount()) != size) {
        refuse(path.string(), "", std::to_string(size) + " bytes" + by,
               "an end after " + std::to_string(stream.gcount()), "copy the file again");
    }
    return bytes;
}

void hashFile(const fs::path& path, ContentHash& hash, const std::string& askedBy) {
    const std::string by = byClause(askedBy);
    regularFileSize(path, by);
    std::ifstream stream = openFile(path, by);
    hash.addStream(stream);
    if (!stream.eof()) {
        refuse(path.string(), "", "a readable file" + by, "a read error", "copy the file again");
    }
}

bool isDataUri(std::string_view uri) {
    return uri.starts_with("data:");
}

Bytes decodeDataUri(const std::string& file, const std::string& place, std::string_view uri) {
    constexpr std::string_view kMark = ";base64,";
    const std::size_t comma = uri.find(',');
    const bool isBase64 = comma != std::string_view::npos && comma + 1 >= kMark.size() &&
                          uri.substr(0, comma + 1).ends_with(kMark);
    if (!isBase64) {
        refuse(file, place, "data:TYPE;base64,...", printable(std::string(uri.substr(0, 40)), 40));
    }
    std::string_view text = uri.substr(comma + 1);
    while (text.ends_with('=')) text.remove_suffix(1);
    if (text.size() % 4 == 1) refuse(file, place, "complete base64 text", "a cut-off one");

    std::array<std::int8_t, 256> value;
    value.fill(-1);
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < kDigits.size(); ++i) {
        value[static_cast<unsigned char>(kDigits[i])] = std::int8_t(i);
    }
    const std::size_t size = text.size() / 4 * 3 + (text.size() % 4 ? text.size() % 4 - 1 : 0);
    Bytes bytes{std::make_unique_for_overwrite<std::uint8_t[]>(size), size};
    std::uint32_t bits = 0;
    std::size_t written = 0;
    int have = 0;
    for (const char c : text) {
        const int digit = value[static_cast<unsigned char>(c)];
        if (digit < 0) refuse(file, place, "base64 text", "another character in it");
        bits = (bits << 6) | std::uint32_t(digit);
        have += 6;
        if (have >= 8) {
            have -= 8;
            bytes.data[written++] = std::uint8_t(bits >> have);
        }
    }
    return bytes;
}

fs::path resolveUri(const std::string& file, const std::string& place, std::string_view uri) {
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            name += uri[i];
            continue;
        }
        const int high = i + 2 < uri.size() ? hexDigit(uri[i + 1]) : -1;
        const int low = i + 2 < uri.size() ? hexDigit(uri[i + 2]) : -1;
        if (high < 0 || low < 0) {
            name += '%';  // a literal per cent sign, from exporters that do not encode
        } else {
            name += char(high * 16 + low);
            i += 2;
        }
    }
    return resolveFileName(file, place, name);
}

fs::path resolveFileName(const std::string& file, const std::string& place, std::string_view name) {
    const bool plain = std::none_of(name.begin(), name.end(), [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    });
    const bool absolute = name.starts_with('/') || name.starts_with('\\');
    if (name.empty() || !plain || absolute || hasScheme(name) || leavesFolder(name)) {
        refuse(file, place, "a file in the scene's folder or below it",
               '"' + printable(std::string(name)) + '"', "put the file beside the scene");
    }
    return fs::path(file).parent_path() / fs::path(name);
}

}  // namespace lacuna::gltf

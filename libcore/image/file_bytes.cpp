#include "libcore/image/file_bytes.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "libcore/base/error.h"
#include "libcore/image/image.h"

namespace lacuna {

std::vector<std::uint8_t> readFileBytes(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) {
        throw InputError(path + ": expected an image, found: " +
                         (error ? error.message() : "No such file or directory") +
                         "; check the name");
    }
    if (!fs::is_regular_file(status)) {
        throw InputError(path + ": expected an image, found " +
                         (fs::is_directory(status) ? "a directory" : "no regular file") +
                         "; name a file");
    }
    std::ifstream in(path, std::ios::binary | std::ios::ate);
    const int openError = errno;
    if (!in) {
        throw InputError(path + ": expected an image that can be read, found: " +
                         std::generic_category().message(openError) + "; check its permissions");
    }
    const auto size = std::streamoff(in.tellg());
    if (size <= 0) {
        throw InputError(path + ": expected an image, found an empty file; write it again");
    }
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
    in.seekg(0);
    if (!in.read(reinterpret_cast<char*>(bytes.data()), size)) {
        throw InputError(path + ": expected " + std::to_string(size) + " bytes, found " +
                         std::to_string(in.gcount()) + "; is the file being written to?");
    }
    return bytes;
}

void requireSaneSize(const std::string& path, std::int64_t width, std::int64_t height) {
    const bool sane = width >= 1 && height >= 1 && width <= kMaxImageSide &&
                      height <= kMaxImageSide &&
                      std::size_t(width) * std::size_t(height) <= kMaxImagePixels;
    if (!sane) {
        throw InputError(path + ": expected 1 to " + std::to_string(kMaxImageSide) +
                         " pixels a side and at most 2^28 in all, found " + std::to_string(width) +
                         " x " + std::to_string(height) + "; is the file damaged?");
    }
}

void requireModestSize(const std::string& path, std::uint64_t pixelBytes, std::uint64_t fileBytes) {
    const std::uint64_t most = kUnpackedFree + kUnpackedPerByte * fileBytes;
    if (pixelBytes <= most) return;
    throw InputError(path + ": expected pixels of at most " + std::to_string(most >> 20) +
                     " MB in a file of " + std::to_string(fileBytes) + " bytes, found " +
                     std::to_string(pixelBytes >> 20) +
                     " MB; write the file again, or scale the picture down");
}

std::uint64_t fewestBytesOfPng(std::span<const std::uint8_t> file, std::uint64_t pixels) {
    constexpr std::size_t kDepth = 24, kColourType = 25;
    constexpr std::uint64_t kSamples[] = {1, 1, 3, 1, 2, 1, 4};
    if (file.size() <= kColourType) return kColourType + 1;
    const std::uint64_t samples = kSamples[std::min<std::size_t>(file[kColourType], 6)];
    return pixels * file[kDepth] * samples / (8 * 1032);
}

bool pngChunksFit(std::span<const std::uint8_t> file) {
    constexpr std::size_t kSignature = 8, kLength = 4, kAround = 12;  // length, name, checksum
    constexpr std::uint8_t kLast[] = {'I', 'E', 'N', 'D'};
    std::size_t at = kSignature;
    while (at + kLength + sizeof kLast <= file.size()) {
        if (std::ranges::equal(file.subspan(at + kLength, sizeof kLast), kLast)) return true;
        std::size_t size = kAround;
        for (std::size_t i = 0; i < kLength; ++i) size += std::size_t(file[at + i]) << (24 - 8 * i);
        if (size > file.size() - at) return false;
        at += size;
    }
    return true;
}

}  // namespace lacuna

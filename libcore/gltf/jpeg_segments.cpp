#include "libcore/gltf/jpeg.h"

#include <algorithm>

namespace lacuna::gltf {
namespace {

constexpr std::size_t kMarker = 2, kLength = 2;

/// Of the segment of Huffman tables (ITU T.81, B.2.4.2) whose content is `size` bytes from `at` on.
bool huffmanTablesFit(std::span<const std::uint8_t> coded, std::size_t at, std::size_t size) {
    constexpr std::size_t kLengths = 16, kCodes = 256;
    for (const std::size_t end = std::min(at + size, coded.size()); at < end;) {
        const auto lengths = coded.subspan(at + 1);
        std::size_t codes = 0;
        for (const std::uint8_t count : lengths.first(std::min(kLengths, lengths.size()))) {
            codes += count;
        }
        if (codes > kCodes) return false;
        at += 1 + kLengths + codes;
    }
    return true;
}

}  // namespace

JpegSegments segmentsOfJpeg(std::span<const std::uint8_t> coded) {
    constexpr std::uint8_t kScan = 0xDA, kTables = 0xC4, kEnd = 0xD9;
    const auto isData = [](std::uint8_t after) {  // 0xFF itself, filling, a restart
        return after == 0x00 || after == 0xFF || (after >= 0xD0 && after <= 0xD7);
    };
    JpegSegments found;
    for (std::size_t at = kMarker; at + kMarker + kLength <= coded.size();) {
        const std::uint8_t marker = coded[at + 1];
        if (coded[at] != 0xFF || isData(marker)) {
            ++at;
            continue;
        }
        if (marker == kEnd) break;
        at += kMarker;
        const std::size_t length = std::size_t(coded[at]) << 8 | coded[at + 1];  // with itself
        if (marker == kScan) ++found.scans;
        if (marker == kTables && length > kLength) {
            found.tablesFit &= huffmanTablesFit(coded, at + kLength, length - kLength);
        }
        at += length;
    }
    return found;
}

}  // namespace lacuna::gltf

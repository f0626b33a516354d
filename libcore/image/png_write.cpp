// Writer of PNG files (ISO/IEC 15948): rows compressed with zlib, 8 or 16 bits per channel.
#include <zlib.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/image/image_io.h"

namespace lacuna {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kSoftware("Software\0Lacuna", 15);
constexpr std::size_t kHeadBytes = 33;  // signature and IHDR

void append(Bytes& bytes, std::uint32_t value) {
    for (const int shift : {24, 16, 8, 0}) bytes.push_back(std::uint8_t(value >> shift));
}

/// A chunk: length, type, content and checksum.
Bytes chunk(std::string_view type, std::string_view content) {
    Bytes bytes;
    append(bytes, std::uint32_t(content.size()));
    bytes.insert(bytes.end(), type.begin(), type.end());
    bytes.insert(bytes.end(), content.begin(), content.end());
    append(bytes, std::uint32_t(crc32(0, bytes.data() + 4, uInt(bytes.size() - 4))));
    return bytes;
}

std::string_view textOf(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

/// The prediction of the filter Paeth: whichever of left, above and both is nearest to left + above
/// - both.
int paeth(int left, int above, int both) {
    const int toLeft = std::abs(above - both), toAbove = std::abs(left - both),
              toBoth = std::abs(left + above - 2 * both);
    if (toLeft <= toAbove && toLeft <= toBoth) return left;
    return toAbove <= toBoth ? above : both;
}

/// Writes the filter's number (0 none, 1 left, 2 above, 4 Paeth) and the filtered row to `to`.
/// `above`: the row above, zeros for the first.
void filter(int number, const std::uint8_t* row, const std::uint8_t* above, std::size_t size,
            std::size_t pixel, Bytes& to) {
    to[0] = std::uint8_t(number);
    for (std::size_t i = 0; i < size; ++i) {
        const int left = i < pixel ? 0 : row[i - pixel], both = i < pixel ? 0 : above[i - pixel];
        const int predicted = number == 0   ? 0
                              : number == 1 ? left
                              : number == 2 ? int(above[i])
                                            : paeth(left, above[i], both);
        to[i + 1] = std::uint8_t(row[i] - predicted);
    }
}

/// The usual heuristic for the filter that compresses best: the smallest sum of absolute
/// differences.
std::uint64_t roughness(const Bytes& filtered) {
    std::uint64_t sum = 0;
    for (const std::uint8_t v : filtered) sum += std::uint64_t(std::abs(int(std::int8_t(v))));
    return sum;
}

/// Compresses rows with deflate and writes them as IDAT chunks.
class Deflater {
  public:
    explicit Deflater(AtomicFile& file) : file_(file) {
        if (deflateInit(&stream_, Z_DEFAULT_COMPRESSION) != Z_OK) {
            throw RunError("PNG: expected memory to compress it, found none; write an .exr");
        }
    }
    ~Deflater() { deflateEnd(&stream_); }
    Deflater(const Deflater&) = delete;
    Deflater& operator=(const Deflater&) = delete;

    void add(Bytes& row) { deflateAll(row.data(), row.size(), Z_NO_FLUSH); }
    void finish() {
        deflateAll(nullptr, 0, Z_FINISH);
        flush();
    }

  private:
    void deflateAll(std::uint8_t* data, std::size_t size, int flushing) {
        stream_.next_in = data;
        stream_.avail_in = uInt(size);
        do {
            if (used_ == buffer_.size()) flush();
            stream_.next_out = buffer_.data() + used_;
            stream_.avail_out = uInt(buffer_.size() - used_);
            deflate(&stream_, flushing);
            used_ = buffer_.size() - stream_.avail_out;
        } while (stream_.avail_out == 0);
    }
    void flush() {
        const Bytes bytes = chunk("IDAT", textOf(buffer_.data(), used_));
        file_.write(bytes.data(), bytes.size());
        used_ = 0;
    }

    AtomicFile& file_;
    z_stream stream_{};
    Bytes buffer_ = Bytes(std::size_t(1) << 16);
    std::size_t used_ = 0;
};

}  // namespace

bool isOurPng(const std::string& path) {
    const Bytes ours = chunk("tEXt", kSoftware);
    std::ifstream file(path, std::ios::binary);
    Bytes bytes(kHeadBytes + ours.size());
    if (!file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()))) {
        return false;
    }
    return textOf(bytes.data() + kHeadBytes, ours.size()) == textOf(ours.data(), ours.size());
}

void writePngBytes(const std::string& path, int width, int height, const Bytes& values, int bits) {
    const std::size_t plane = std::size_t(width) * std::size_t(height) * std::size_t(bits / 8);
    const bool withAlpha = values.size() == 4 * plane;
    if ((bits != 8 && bits != 16) || (!withAlpha && values.size() != 3 * plane)) {
        throw std::invalid_argument("PNG: bytes do not match the size");
    }
    const std::size_t pixel = std::size_t((withAlpha ? 4 : 3) * bits / 8),
                      size = std::size_t(width) * pixel;
    AtomicFile file(path);
    file.write(kSignature.data(), kSignature.size());
    Bytes head;
    append(head, std::uint32_t(width));
    append(head, std::uint32_t(height));
    // Colour type 2: red, green, blue; 6: with alpha.
    head.insert(head.end(), {std::uint8_t(bits), std::uint8_t(withAlpha ? 6 : 2), 0, 0, 0});
    for (const Bytes& bytes :
         {chunk("IHDR", textOf(head.data(), head.size())), chunk("tEXt", kSoftware)}) {
        file.write(bytes.data(), bytes.size());
    }

    Deflater deflater(file);
    const Bytes zeros(size);
    Bytes best(size + 1), other(size + 1);
    for (int y = 0; y < height; ++y) {
        const std::uint8_t* row = values.data() + std::size_t(y) * size;
        const std::uint8_t* above = y > 0 ? row - size : zeros.data();
        std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
        for (const int number : {0, 1, 2, 4}) {
            filter(number, row, above, size, pixel, other);
            if (const std::uint64_t sum = roughness(other); sum < least) {
                least = sum;
                best.swap(other);
            }
        }
        deflater.add(best);
    }
    deflater.finish();
    const Bytes end = chunk("IEND", {});
    file.write(end.data(), end.size());
    file.commit();
}

void writePng(const std::string& path, const Image& image, const PngStyle& style,
              const std::vector<float>* alpha) {
    writePngBytes(path, image.width, image.height, developed(image, style, alpha), style.bits);
}

}  // namespace lacuna

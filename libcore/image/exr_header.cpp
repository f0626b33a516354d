#include "libcore/image/exr_header.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>

#include "libcore/base/error.h"
#include "libcore/image/file_bytes.h"
#include "libcore/image/image.h"

namespace lacuna {
namespace {

// Bits of the version field, OpenEXR file layout, "Version Field".
constexpr std::uint32_t kTiled = 0x200, kDeep = 0x800, kMultiPart = 0x1000;

struct Box {
    std::int32_t minX, minY, maxX, maxY;
    std::int64_t width() const { return std::int64_t(maxX) - minX + 1; }
    std::int64_t height() const { return std::int64_t(maxY) - minY + 1; }
};
struct Tile {
    std::uint32_t width, height;
};

/// Reads forward through the bytes and never past their end. EXR is little-endian, as are we.
class Cursor {
  public:
    Cursor(const std::string& path, const std::vector<std::uint8_t>& bytes)
        : path_(path), bytes_(bytes) {}

    std::size_t left() const { return bytes_.size() - position_; }
    template <class T>
    T value() {
        T out{};
        std::memcpy(&out, take(sizeof(T)), sizeof(T));
        return out;
    }
    /// Up to the next NUL, which is passed over.
    std::string text() {
        const auto from = bytes_.begin() + std::ptrdiff_t(position_);
        const auto end = std::find(from, bytes_.end(), std::uint8_t(0));
        const std::string out(from, end);
        take(out.size() + 1);
        return out;
    }
    /// Whether the next byte is this one, which is then passed over.
    bool passes(std::uint8_t byte) {
        const bool is = left() > 0 && bytes_[position_] == byte;
        if (is) ++position_;
        return is;
    }
    const std::uint8_t* take(std::size_t n) {
        if (n > left()) {
            throw InputError(path_ + ": expected " + std::to_string(n) +
                             " more bytes of EXR header, found " + std::to_string(left()) +
                             "; the file is damaged or cut off, write it again");
        }
        const std::uint8_t* at = bytes_.data() + position_;
        position_ += n;
        return at;
    }

  private:
    const std::string& path_;
    const std::vector<std::uint8_t>& bytes_;
    std::size_t position_ = 0;
};

void requireTiles(const std::string& path, const Tile& tile, const Box& window, std::size_t bytes) {
    const auto side = std::uint32_t(kMaxImageSide);
    const auto ceilDiv = [](std::int64_t a, std::int64_t b) { return (a + b - 1) / b; };
    bool sane = tile.width >= 1 && tile.height >= 1 && tile.width <= side && tile.height <= side;
    // OpenEXR holds a whole row of tiles, and 8 bytes of table per tile.
    sane = sane && std::size_t(tile.width) * tile.height <= kMaxImagePixels &&
           std::size_t(window.width()) * tile.height <= kMaxImagePixels &&
           std::size_t(ceilDiv(window.width(), tile.width) *
                       ceilDiv(window.height(), tile.height)) <= bytes / 8;
    if (!sane) {
        throw InputError(path + ": expected tiles that fit the image and the file, found " +
                         std::to_string(tile.width) + " x " + std::to_string(tile.height) +
                         "; is the file damaged?");
    }
}

/// What a part says of itself.
struct PartHeader {
    Box window{};
    std::optional<Tile> tile;
    std::size_t chunks = 0;  ///< as it claims; at least one for every 256 lines

    void checkTiles(const std::string& path, std::size_t bytes) const {
        if (tile) requireTiles(path, *tile, window, bytes);
    }
};

PartHeader readHeader(const std::string& path, Cursor& cursor) {
    std::optional<Box> window;
    PartHeader header;
    for (std::string name = cursor.text(); !name.empty(); name = cursor.text()) {
        const std::string type = cursor.text();
        const auto size = cursor.value<std::int32_t>();
        // A negative size becomes a huge one and is refused by take().
        Cursor content = cursor;
        cursor.take(size < 0 ? std::numeric_limits<std::size_t>::max() : std::size_t(size));
        if (name == "dataWindow" && type == "box2i" && size == 16) {
            window = content.value<Box>();
            requireSaneSize(path, window->width(), window->height());
        } else if (name == "tiles" && type == "tiledesc" && size == 9) {
            header.tile = content.value<Tile>();
        } else if (name == "chunkCount" && type == "int" && size == 4) {
            header.chunks = std::size_t(std::max(0, content.value<std::int32_t>()));
        }
    }
    if (!window) {
        throw InputError(path +
                         ": expected a dataWindow in the EXR header, found none; "
                         "the file is damaged, write it again");
    }
    header.window = *window;
    header.chunks = std::max(header.chunks, std::size_t(window->height() + 255) / 256);
    return header;
}

}  // namespace

void checkExrHeader(const std::string& path, const std::vector<std::uint8_t>& bytes) {
    Cursor cursor(path, bytes);
    if (bytes.size() < 8 || cursor.value<std::uint32_t>() != 20000630u) {
        throw InputError(path + ": expected an OpenEXR file, found something else; name an .exr");
    }
    const auto version = cursor.value<std::uint32_t>();
    if (version & kDeep) {
        throw InputError(path + ": expected a flat image, found a deep one; convert the file");
    }
    if (!(version & kMultiPart)) {
        const PartHeader header = readHeader(path, cursor);
        if (version & kTiled) header.checkTiles(path, bytes.size());
        return;
    }
    std::size_t chunks = 0;
    do {
        const PartHeader header = readHeader(path, cursor);
        header.checkTiles(path, bytes.size());
        // OpenEXR makes room for all that each part claims.
        chunks += header.chunks;
        if (chunks > bytes.size() / 8) {
            throw InputError(path + ": expected parts that fit the file, found too many scan " +
                             "lines; is the file damaged?");
        }
    } while (!cursor.passes(0));
}

}  // namespace lacuna

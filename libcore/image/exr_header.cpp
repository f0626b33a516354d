#include "libcore/image/exr_header.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

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

/// Reads forward through the bytes and never past their end. EXR is little-endian, like the
/// supported machines.
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
    /// The text up to the next NUL, which is skipped.
    std::string text() {
        const auto from = bytes_.begin() + std::ptrdiff_t(position_);
        const auto end = std::find(from, bytes_.end(), std::uint8_t(0));
        const std::string out(from, end);
        take(out.size() + 1);
        return out;
    }
    /// Skips the next byte if it is this one; tells whether it was.
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
    // OpenEXR allocates a whole row of tiles, and 8 bytes of table per tile.
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

/// Size in bytes of an attribute of this type; empty if it depends on the value.
std::optional<std::size_t> sizeOf(std::string_view type) {
    struct Fixed {
        std::string_view type;
        std::size_t size;
    };
    static constexpr Fixed kFixed[] = {
        {"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
        {"compression", 1}, {"double", 8},   {"envmap", 1},
        {"float", 4},       {"int", 4},      {"keycode", 28},
        {"m33d", 72},       {"m33f", 36},    {"m44d", 128},
        {"m44f", 64},       {"v2d", 16},     {"v2f", 8},
        {"v2i", 8},         {"v3d", 24},     {"v3f", 12},
        {"v3i", 12},        {"rational", 8}, {"lineOrder", 1},
        {"timecode", 8},    {"tiledesc", 9}, {"deepImageState", 1},
    };
    const auto* const found = std::ranges::find(kFixed, type, &Fixed::type);
    return found == std::end(kFixed) ? std::nullopt : std::optional(found->size);
}

/// Skips the value like OpenEXR, by its content and not by the size that the file gives: after a value of another size,
/// OpenEXR would misread everything.
void passOver(Cursor& content, std::string_view type, std::size_t size) {
    if (const auto fixed = sizeOf(type)) {
        content.take(*fixed);
    } else if (type == "chlist") {
        while (!content.text().empty()) content.take(16);
    } else if (type == "stringvector") {
        for (const std::size_t end = content.left() - size; content.left() > end;) {
            content.take(content.value<std::uint32_t>());
        }
    } else if (type == "preview") {
        const std::uint64_t width = content.value<std::uint32_t>();
        const std::uint64_t height = content.value<std::uint32_t>();
        // Clamped to just above the largest side, which is too large already.
        const auto most = std::uint64_t(kMaxImageSide) + 1;
        content.take(std::min(width, most) * std::min(height, most) * 4);
    } else if (type == "floatvector") {
        content.take(size / 4 * 4);
    } else {
        content.take(size);
    }
}

/// The header of one part.
struct PartHeader {
    Box window{};
    std::optional<Tile> tile;
    std::size_t chunks = 0;  ///< claimed number; at least one for every 256 lines

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
        Cursor content = cursor, read = cursor;
        cursor.take(size < 0 ? std::numeric_limits<std::size_t>::max() : std::size_t(size));
        passOver(read, type, std::size_t(size));
        if (read.left() != cursor.left()) {
            throw InputError(path + ": expected attributes as long as their values, found one of " +
                             std::to_string(size) + " bytes that is not; the file is damaged, " +
                             "write it again");
        }
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
        // OpenEXR allocates all that each part claims.
        chunks += header.chunks;
        if (chunks > bytes.size() / 8) {
            throw InputError(path + ": expected parts that fit the file, found too many scan " +
                             "lines; is the file damaged?");
        }
    } while (!cursor.passes(0));
}

}  // namespace lacuna

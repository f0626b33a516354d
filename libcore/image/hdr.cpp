// Radiance .hdr. It is not read with stb_image: Debian's version (2.27) loops for ever in a
// truncated run-length coded file and reads a truncated flat one as black.
#include <charconv>
#include <cmath>
#include <string_view>

#include "libcore/base/error.h"
#include "libcore/image/file_bytes.h"
#include "libcore/image/image_io.h"

namespace lacuna {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& expected) {
    throw InputError(path + ": expected " + expected +
                     ", found something else; the file is damaged or no Radiance .hdr");
}

class Scanner {
  public:
    Scanner(const std::string& path, const std::vector<std::uint8_t>& bytes, std::size_t at = 0)
        : path_(path), bytes_(bytes), at_(at) {}

    std::uint8_t byte() {
        if (at_ >= bytes_.size()) fail(path_, "more pixels");
        return bytes_[at_++];
    }
    std::string_view line() {
        const std::string_view all(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
        const std::size_t end = all.find('\n', at_);
        if (end == std::string_view::npos) fail(path_, "another header line");
        const std::string_view out = all.substr(at_, end - at_);
        at_ = end + 1;
        return out;
    }
    std::size_t at() const { return at_; }

  private:
    const std::string& path_;
    const std::vector<std::uint8_t>& bytes_;
    std::size_t at_;
};

struct Rgbe {
    std::uint8_t v[4];
    // Ward's format: mantissa / 256 * 2^(e - 128); a zero exponent is black.
    Rgb colour() const {
        if (v[3] == 0) return {};
        const float scale = std::ldexp(1.0f, int(v[3]) - (128 + 8));
        return {v[0] * scale, v[1] * scale, v[2] * scale};
    }
};

/// Reads a run-length coded row, one component after the other, after the marker 2 2 width.
void readRuns(const std::string& path, Scanner& in, std::vector<Rgbe>& row) {
    for (int c = 0; c < 4; ++c) {
        for (std::size_t x = 0; x < row.size();) {
            const std::uint8_t code = in.byte();
            const bool run = code > 128;
            const std::size_t count = run ? code - 128u : code;
            if (count == 0 || count > row.size() - x) fail(path, "a run inside its row");
            const std::uint8_t value = run ? in.byte() : std::uint8_t(0);
            for (std::size_t i = 0; i < count; ++i) row[x++].v[c] = run ? value : in.byte();
        }
    }
}

/// Reads one row: run-length coded if it begins with the marker (only for widths 8..32767), else
/// flat.
void readRow(const std::string& path, Scanner& in, std::vector<Rgbe>& row) {
    std::size_t x = 0;
    if (row.size() >= 8 && row.size() < 32768) {
        Rgbe first{};
        for (std::uint8_t& v : first.v) v = in.byte();
        if (first.v[0] == 2 && first.v[1] == 2 && first.v[2] < 128) {
            if (std::size_t(first.v[2] * 256 + first.v[3]) != row.size()) {
                fail(path, "rows of " + std::to_string(row.size()) + " pixels");
            }
            return readRuns(path, in, row);
        }
        row[x++] = first;
    }
    for (; x < row.size(); ++x) {
        for (std::uint8_t& v : row[x].v) v = in.byte();
        if (row[x].v[0] == 1 && row[x].v[1] == 1 && row[x].v[2] == 1) {
            fail(path, "flat or per-component run-length coded rows (not the old RLE)");
        }
    }
}

/// Parses "-Y height +X width", the only orientation in use.
ImageSize parseSize(const std::string& path, std::string_view line) {
    const auto number = [&](std::string_view prefix) {
        if (line.substr(0, prefix.size()) != prefix) fail(path, "a size '-Y height +X width'");
        line.remove_prefix(prefix.size());
        int out = 0;
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), out);
        if (error != std::errc()) fail(path, "a size '-Y height +X width'");
        line.remove_prefix(std::size_t(end - line.data()));
        return out;
    };
    const int height = number("-Y "), width = number(" +X ");
    requireSaneSize(path, width, height);
    return {width, height};
}

/// Reads all lines before the first row; returns the size.
ImageSize readHeader(const std::string& path, Scanner& in) {
    const std::string_view magic = in.line();
    if (magic.substr(0, 10) != "#?RADIANCE" && magic.substr(0, 6) != "#?RGBE") {
        fail(path, "'#?RADIANCE'");
    }
    bool isRgbe = false;
    for (std::string_view line = in.line(); !line.empty() && line != "\r"; line = in.line()) {
        isRgbe = isRgbe || line.substr(0, 22) == "FORMAT=32-bit_rle_rgbe";
    }
    if (!isRgbe) fail(path, "FORMAT=32-bit_rle_rgbe");
    return parseSize(path, in.line());
}

Image readRows(const std::string& path, Scanner in, ImageSize size) {
    Image image(size.width, size.height);
    std::vector<Rgbe> row(static_cast<std::size_t>(size.width));
    for (int y = 0; y < size.height; ++y) {
        readRow(path, in, row);
        for (int x = 0; x < size.width; ++x) image.at(x, y) = row[std::size_t(x)].colour();
    }
    return image;
}

}  // namespace

ImageFile openHdr(const std::string& path) {
    std::vector<std::uint8_t> bytes = readFileBytes(path);
    Scanner in(path, bytes);
    const ImageSize size = readHeader(path, in);
    // A run takes two bytes and has at most 127 pixels, for each of four components.
    if (bytes.size() < std::size_t(size.width) * std::size_t(size.height) * 8 / 127) {
        fail(path, "more pixels");
    }
    return {size, [=, at = in.at(), bytes = std::move(bytes)] {
                return readRows(path, Scanner(path, bytes, at), size);
            }};
}

}  // namespace lacuna

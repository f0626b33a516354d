// PFM: "PF" (colour) or "Pf" (grey), width, height, a scale whose sign gives the byte order, one
// white space, then raw floats, bottom row first.
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/image/file_bytes.h"
#include "libcore/image/image_io.h"

namespace lacuna {
namespace {

static_assert(std::endian::native == std::endian::little && sizeof(Rgb) == 3 * sizeof(float));

struct PfmHeader {
    int channels = 3;
    ImageSize image;
    bool bigEndian = false;
    std::size_t size = 0;  // bytes up to the first float
};

[[noreturn]] void failHeader(const std::string& path) {
    throw InputError(path +
                     ": expected a PFM header 'PF width height scale', found something "
                     "else; the file is damaged or no PFM");
}

/// The next word; also skips the single white space after it.
std::string_view nextWord(const std::string& path, std::string_view text, std::size_t& at) {
    const auto space = [&](std::size_t i) {
        return std::isspace(static_cast<unsigned char>(text[i])) != 0;
    };
    while (at < text.size() && space(at)) ++at;
    const std::size_t from = at;
    while (at < text.size() && !space(at)) ++at;
    if (at == text.size()) failHeader(path);
    return text.substr(from, at++ - from);
}

template <class T>
T number(const std::string& path, std::string_view word) {
    T out{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
    if (error != std::errc() || end != word.data() + word.size()) failHeader(path);
    return out;
}

PfmHeader parseHeader(const std::string& path, std::string_view text) {
    PfmHeader header;
    std::size_t at = 0;
    const std::string_view magic = nextWord(path, text, at);
    if (magic != "PF" && magic != "Pf") failHeader(path);
    header.channels = magic == "PF" ? 3 : 1;
    header.image.width = number<int>(path, nextWord(path, text, at));
    header.image.height = number<int>(path, nextWord(path, text, at));
    const float scale = number<float>(path, nextWord(path, text, at));
    if (!std::isfinite(scale) || scale == 0.0f) failHeader(path);
    header.bigEndian = scale > 0.0f;
    header.size = at;
    requireSaneSize(path, header.image.width, header.image.height);
    return header;
}

float loadFloat(const std::uint8_t* from, bool bigEndian) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, from, 4);
    return std::bit_cast<float>(bigEndian ? __builtin_bswap32(bits) : bits);
}

/// `from`: the first float.
Image decodePfm(const PfmHeader& header, const std::uint8_t* from) {
    Image image(header.image.width, header.image.height);
    for (int y = image.height - 1; y >= 0; --y) {
        for (int x = 0; x < image.width; ++x) {
            float v[3];
            for (int c = 0; c < header.channels; ++c, from += 4) {
                v[c] = loadFloat(from, header.bigEndian);
            }
            image.at(x, y) = header.channels == 3 ? Rgb(v[0], v[1], v[2]) : Rgb(v[0]);
        }
    }
    return image;
}

}  // namespace

ImageFile openPfm(const std::string& path) {
    std::vector<std::uint8_t> bytes = readFileBytes(path);
    const PfmHeader header =
        parseHeader(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const std::size_t floats =
        std::size_t(header.image.width) * header.image.height * header.channels;
    if (bytes.size() - header.size != floats * 4) {
        throw InputError(path + ": expected " + std::to_string(floats * 4) +
                         " bytes of pixels, found " + std::to_string(bytes.size() - header.size) +
                         "; the file is damaged, write it again");
    }
    return {header.image, [header, bytes = std::move(bytes)] {
                return decodePfm(header, bytes.data() + header.size);
            }};
}

void writePfm(const std::string& path, const Image& image) {
    AtomicFile file(path);
    const std::string header =
        "PF\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n-1.0\n";
    file.write(header.data(), header.size());
    for (int y = image.height - 1; y >= 0; --y) {
        file.write(&image.at(0, y), sizeof(Rgb) * std::size_t(image.width));
    }
    file.commit();
}

}  // namespace lacuna

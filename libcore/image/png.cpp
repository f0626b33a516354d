#include <stb/stb_image.h>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/image/file_bytes.h"
#include "libcore/image/image_io.h"

namespace lacuna {
namespace {

// IEC 61966-2-1, both ways, on [0, 1].
double srgbToLinear(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
double linearToSrgb(double v) {
    return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

std::uint8_t encode(double v) {
    if (!(v > 0.0)) return 0;  // NaN too
    return std::uint8_t(std::lround(255.0 * linearToSrgb(std::min(v, 1.0))));
}

/// `T` is the stored integer; `from` holds 3 * pixels of them. One table entry per code value.
template <class T>
void decode(const T* from, Image& image) {
    constexpr int kMax = std::numeric_limits<T>::max();
    std::vector<float> linear(kMax + 1);
    for (int i = 0; i <= kMax; ++i) linear[std::size_t(i)] = float(srgbToLinear(double(i) / kMax));
    for (Rgb& pixel : image.pixels) {
        pixel = {linear[from[0]], linear[from[1]], linear[from[2]]};
        from += 3;
    }
}

struct StbFree {
    void operator()(void* p) const { stbi_image_free(p); }
};

[[noreturn]] void fail(const std::string& path, const std::string& found) {
    throw InputError(path + ": expected an intact PNG file, found: " + found + "; write it again");
}

/// What stb_image says of its last failure, which may be nothing.
std::string reason() {
    const char* text = stbi_failure_reason();
    return text && *text ? text : "a damaged one";
}

constexpr std::size_t kHeadBytes = 33;  // signature and IHDR
/// A chunk tEXt, "Software" "Lacuna", with its length and checksum.
constexpr std::array<std::uint8_t, 27> kSoftware{0,   0,   0,   15,  't', 'E',  'X',  't',  'S',
                                                 'o', 'f', 't', 'w', 'a', 'r',  'e',  0,    'L',
                                                 'a', 'c', 'u', 'n', 'a', 0xb7, 0xb6, 0x2e, 0xc0};

}  // namespace

bool isOurPng(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, kHeadBytes + kSoftware.size()> bytes{};
    if (!file.read(bytes.data(), bytes.size())) return false;
    return std::equal(kSoftware.begin(), kSoftware.end(), bytes.begin() + kHeadBytes,
                      [](std::uint8_t a, char b) { return a == std::uint8_t(b); });
}

Image readPng(const std::string& path) {
    const std::vector<std::uint8_t> bytes = readFileBytes(path);
    // stb_image goes by content and would try its weaker readers on whatever this is.
    constexpr std::array<std::uint8_t, 8> magic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    if (bytes.size() < 8 || !std::equal(magic.begin(), magic.end(), bytes.begin())) {
        fail(path, "no PNG signature");
    }
    if (bytes.size() > std::size_t(std::numeric_limits<int>::max())) fail(path, "more than 2 GB");
    const int size = int(bytes.size());
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels)) {
        fail(path, reason());
    }
    requireSaneSize(path, width, height);

    Image image(width, height);
    const auto read = [&](auto* loaded) {
        const std::unique_ptr<std::remove_pointer_t<decltype(loaded)>, StbFree> data(loaded);
        if (!data) fail(path, reason());
        decode(data.get(), image);
    };
    if (stbi_is_16_bit_from_memory(bytes.data(), size)) {
        read(stbi_load_16_from_memory(bytes.data(), size, &width, &height, &channels, 3));
    } else {
        read(stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 3));
    }
    return image;
}

void writePngBytes(const std::string& path, int width, int height,
                   const std::vector<std::uint8_t>& rgb) {
    if (rgb.size() != std::size_t(width) * std::size_t(height) * 3) {
        throw std::invalid_argument("PNG: bytes do not match the size");
    }
    // stb counts in int and holds the picture three times over.
    if (rgb.size() > std::size_t(std::numeric_limits<int>::max()) / 2) {
        throw RunError(path + ": expected at most 2^30 bytes for a PNG, found " +
                       std::to_string(rgb.size()) + "; write an .exr");
    }
    AtomicFile file(path);
    // Once, with all bytes. No exception may pass through stb: C code calls this back. AtomicFile
    // remembers the failure.
    const auto write = [](void* context, void* data, int bytes) noexcept {
        try {
            AtomicFile& to = *static_cast<AtomicFile*>(context);
            to.write(data, kHeadBytes);
            to.write(kSoftware.data(), kSoftware.size());
            to.write(static_cast<const char*>(data) + kHeadBytes, std::size_t(bytes) - kHeadBytes);
        } catch (const Error&) {
        }
    };
    if (!stbi_write_png_to_func(write, &file, width, height, 3, rgb.data(), width * 3)) {
        throw RunError(path + ": expected to encode a PNG, found: out of memory; write an .exr");
    }
    file.commit();
}

void writePng(const std::string& path, const Image& image, double exposure) {
    const double scale = std::exp2(exposure);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.pixels.size() * 3);
    for (const Rgb& p : image.pixels) {
        for (const float v : {p.r, p.g, p.b}) bytes.push_back(encode(v * scale));
    }
    writePngBytes(path, image.width, image.height, bytes);
}

}  // namespace lacuna

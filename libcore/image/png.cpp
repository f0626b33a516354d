#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "libcore/base/error.h"
#include "libcore/base/printable.h"
#include "libcore/image/file_bytes.h"
#include "libcore/image/image_io.h"
#include "libcore/image/tone.h"

namespace lacuna {
namespace {

/// Converts `from`, 3 * pixels stored integers T, to linear values with a table over all code
/// values.
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

/// stb_image's reason for its last failure, which may be null or contain bytes of the file.
std::string reason() {
    const char* said = stbi_failure_reason();
    return said && *said ? printable(said) : "a damaged one";
}

/// The size in a PNG's header. Throws InputError unless stb_image may decode `bytes`.
ImageSize checkedSize(const std::string& path, const std::vector<std::uint8_t>& bytes) {
    // stb_image detects the format by content and would try its weaker readers on other files.
    constexpr std::array<std::uint8_t, 8> magic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    if (bytes.size() < 8 || !std::equal(magic.begin(), magic.end(), bytes.begin())) {
        fail(path, "no PNG signature");
    }
    if (bytes.size() > std::size_t(std::numeric_limits<int>::max())) fail(path, "more than 2 GB");
    if (!pngChunksFit(bytes)) fail(path, "a part that ends beyond the file");
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(bytes.data(), int(bytes.size()), &width, &height, &channels)) {
        fail(path, reason());
    }
    requireSaneSize(path, width, height);
    const std::uint64_t pixels = std::uint64_t(width) * std::uint64_t(height);
    const std::uint64_t fewest = fewestBytesOfPng(bytes, pixels);
    if (bytes.size() < fewest) {
        fail(path, std::to_string(bytes.size()) + " bytes, where so large a picture has " +
                       std::to_string(fewest) + " at least");
    }
    requireModestSize(path, pixels * sizeof(Rgb), bytes.size());
    return {width, height};
}

Image decodePng(const std::string& path, const std::vector<std::uint8_t>& bytes) {
    const int size = int(bytes.size());
    int width = 0, height = 0, channels = 0;
    const auto image = [&](auto* loaded) {
        const std::unique_ptr<std::remove_pointer_t<decltype(loaded)>, StbFree> data(loaded);
        if (!data) fail(path, reason());
        Image decoded(width, height);
        decode(data.get(), decoded);
        return decoded;
    };
    return stbi_is_16_bit_from_memory(bytes.data(), size)
               ? image(stbi_load_16_from_memory(bytes.data(), size, &width, &height, &channels, 3))
               : image(stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 3));
}

}  // namespace

ImageFile openPng(const std::string& path) {
    std::vector<std::uint8_t> bytes = readFileBytes(path);
    const ImageSize size = checkedSize(path, bytes);
    return {size, [path, bytes = std::move(bytes)] { return decodePng(path, bytes); }};
}

}  // namespace lacuna

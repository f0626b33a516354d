// stb_image's decoder of JPEG, compiled here: it reads tables and coefficients that a damaged file does not give,
// so its memory begins as zeros.
#include <cstdlib>

#include "libcore/gltf/jpeg.h"

#define STBI_MALLOC(size) std::calloc(1, size)
#define STBI_REALLOC(block, size) std::realloc(block, size)
#define STBI_FREE(block) std::free(block)
#define STBI_ONLY_JPEG
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

namespace lacuna::gltf {

bool readJpegSize(std::span<const std::uint8_t> coded, int& width, int& height) {
    int channels = 0;
    return stbi_info_from_memory(coded.data(), int(coded.size()), &width, &height, &channels);
}

DecodedImage decodeJpeg(std::span<const std::uint8_t> coded) {
    DecodedImage image;
    int channels = 0;
    image.texels.reset(stbi_load_from_memory(coded.data(), int(coded.size()), &image.width,
                                             &image.height, &channels, STBI_rgb_alpha));
    if (!image.texels) image.damage = stbi_failure_reason();
    return image;
}

}  // namespace lacuna::gltf

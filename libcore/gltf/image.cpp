#include "libcore/gltf/image.h"

#include <stb/stb_image.h>
#include <webp/decode.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "libcore/gltf/in_parallel.h"
#include "libcore/gltf/jpeg.h"
#include "libcore/gltf/limits.h"
#include "libcore/image/file_bytes.h"

namespace lacuna::gltf {
namespace {

/// A used image: its coded bytes, then its texels (8-bit RGBA).
struct Picture {
    int image = 0;
    std::string place;
    Bytes owned;
    std::span<const std::uint8_t> coded;
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    int uses = 0;  ///< textures still to be made from it

    std::uint64_t texels() const { return std::uint64_t(width) * std::uint64_t(height); }
};

/// The coded bytes of image `index`: a checked buffer view, a data URI or an external file.
void readCoded(Document& document, Picture& picture) {
    const nlohmann::json& image = document.json["images"][std::size_t(picture.image)];
    const auto uri = image.find("uri");
    const auto view = image.find("bufferView");
    if ((uri == image.end()) == (view == image.end())) {
        refuse(document.file, picture.place, "either a uri or a bufferView",
               uri == image.end() ? "neither" : "both");
    }
    if (view != image.end()) {
        picture.coded = document.view(view->get<int>());
        return;
    }
    const auto& text = uri->get_ref<const std::string&>();
    picture.owned = isDataUri(text) ? decodeDataUri(document.file, picture.place + ".uri", text)
                                    : document.readExternal(
                                          resolveUri(document.file, picture.place + ".uri", text),
                                          document.file + ", " + picture.place);
    picture.coded = picture.owned.span();
}

constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G'}, kJpeg[] = {0xFF, 0xD8, 0xFF};

constexpr const char* kKinds = "a PNG, JPEG or WebP image";

bool startsWith(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> magic) {
    return bytes.size() > magic.size() &&
           std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

bool isJpeg(std::span<const std::uint8_t> bytes) {
    return startsWith(bytes, kJpeg);
}

bool isWebp(std::span<const std::uint8_t> bytes) {
    constexpr std::size_t kForm = 8;  // after RIFF and a length
    constexpr std::uint8_t kRiff[] = {'R', 'I', 'F', 'F'}, kWebp[] = {'W', 'E', 'B', 'P'};
    return startsWith(bytes, kRiff) && bytes.size() > kForm &&
           startsWith(bytes.subspan(kForm), kWebp);
}

/// The fewest bytes that can hold this number of texels: decoders would allocate whatever the header claims. A JPEG has
/// at least one bit per block of 64 texels. A WebP of one colour holds any number in 30 bytes.
std::uint64_t fewestBytes(std::span<const std::uint8_t> coded, std::uint64_t texels) {
    if (isWebp(coded)) return 0;
    return startsWith(coded, kPng) ? fewestBytesOfPng(coded, texels) : texels / (64 * 8);
}

/// Reads width and height from the header. False if it is damaged or that of an animation.
bool readHeader(Picture& picture) {
    const auto coded = picture.coded;
    if (isWebp(coded)) {
        WebPBitstreamFeatures features;
        if (WebPGetFeatures(coded.data(), coded.size(), &features) != VP8_STATUS_OK) return false;
        picture.width = features.width;
        picture.height = features.height;
        return !features.has_animation;
    }
    if (coded.size() > std::size_t(std::numeric_limits<int>::max())) return false;
    if (isJpeg(coded)) return readJpegSize(coded, picture.width, picture.height);
    int channels = 0;
    return pngChunksFit(coded) && stbi_info_from_memory(coded.data(), int(coded.size()),
                                                        &picture.width, &picture.height, &channels);
}

/// Refuses what the decoder would believe, or work at for minutes.
void checkJpeg(const Document& document, const Picture& picture) {
    const JpegSegments segments = segmentsOfJpeg(picture.coded);
    if (!segments.tablesFit) {
        refuse(document.file, picture.place, "Huffman tables of at most 256 codes", "a longer one",
               "save the image again");
    }
    if (segments.scans > Limits::kJpegScans) {
        refuse(document.file, picture.place,
               "at most " + std::to_string(Limits::kJpegScans) + " scans",
               std::to_string(segments.scans), "save the image again");
    }
}

/// Takes memory from the allowance: a picture of one colour has a few bytes, whatever its size.
void takeMemory(Document& document, const Picture& picture, std::uint64_t bytes) {
    if (!document.allowance.take(bytes)) {
        refuseUnpacking(document, picture.place, "scale the image down");
    }
}

/// Reads the picture's size from its header. Nothing of that size is allocated before it is
/// accepted.
void readSize(Document& document, Picture& picture) {
    const auto coded = picture.coded;
    if (!startsWith(coded, kPng) && !isJpeg(coded) && !isWebp(coded)) {
        refuse(document.file, picture.place, kKinds, "something else", "convert the image");
    }
    if (isJpeg(coded)) checkJpeg(document, picture);
    if (!readHeader(picture)) {
        refuse(document.file, picture.place, kKinds,
               isWebp(coded) ? "a damaged header or an animated image" : "a damaged header",
               "save the image again");
    }
    const std::uint64_t texels = picture.texels();
    if (picture.width < 1 || picture.height < 1 || picture.width > Limits::kImageSide ||
        picture.height > Limits::kImageSide || texels > Limits::kImageTexels) {
        refuse(document.file, picture.place,
               "an image of at most " + std::to_string(Limits::kImageTexels) + " texels",
               std::to_string(picture.width) + " x " + std::to_string(picture.height),
               "scale the image down");
    }
    if (coded.size() < fewestBytes(coded, texels)) {
        refuse(document.file, picture.place,
               "at least " + std::to_string(fewestBytes(coded, texels)) + " bytes for " +
                   std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                   " texels",
               std::to_string(coded.size()), "save the image again");
    }
    // libwebp holds the texels twice. stb_image holds them with 16 bits per sample, and once more
    // as deflate decoded them.
    takeMemory(document, picture, texels * (isWebp(coded) ? 4 : 12));
}

void decodeWebp(const Document& document, Picture& picture) {
    picture.rgba.resize(std::size_t(picture.width) * std::size_t(picture.height) * 4);
    if (!WebPDecodeRGBAInto(picture.coded.data(), picture.coded.size(), picture.rgba.data(),
                            picture.rgba.size(), picture.width * 4)) {
        refuse(document.file, picture.place, kKinds, "a damaged one", "save the image again");
    }
    picture.owned = {};
}

/// Converts texels of 1 to 4 channels (grey, grey and alpha, RGB, RGBA) to RGBA.
std::vector<std::uint8_t> rgbaOf(const DecodedImage& image) {
    const std::uint8_t* from = image.texels.get();
    const std::size_t size = std::size_t(image.width) * std::size_t(image.height) * 4;
    if (image.channels == STBI_rgb_alpha) return {from, from + size};
    const int green = image.channels == STBI_rgb ? 1 : 0, blue = 2 * green;
    const bool hasAlpha = image.channels == STBI_grey_alpha;
    std::vector<std::uint8_t> rgba(size);
    for (std::size_t i = 0; i < size; i += 4, from += image.channels) {
        rgba[i] = from[0];
        rgba[i + 1] = from[green];
        rgba[i + 2] = from[blue];
        rgba[i + 3] = hasAlpha ? from[1] : std::uint8_t(255);
    }
    return rgba;
}

/// Keeps the channels that the file has: stb_image would convert them in a buffer of its own, which
/// then would be copied.
DecodedImage decodePng(std::span<const std::uint8_t> coded) {
    DecodedImage image;
    image.texels.reset(stbi_load_from_memory(coded.data(), int(coded.size()), &image.width,
                                             &image.height, &image.channels, STBI_default));
    if (!image.texels) image.damage = stbi_failure_reason();
    return image;
}

void decodePicture(const Document& document, Picture& picture) {
    if (isWebp(picture.coded)) return decodeWebp(document, picture);
    const DecodedImage image =
        isJpeg(picture.coded) ? decodeJpeg(picture.coded) : decodePng(picture.coded);
    if (!image.texels || image.width != picture.width || image.height != picture.height) {
        refuse(document.file, picture.place, kKinds,
               image.damage && *image.damage ? std::string("a damaged one (") + image.damage + ")"
                                             : "a damaged one",
               "save the image again");
    }
    picture.rgba = rgbaOf(image);
    picture.owned = {};
}

}  // namespace

Texture::Wrap TextureTable::wrap(int sampler, int mode, const char* name) const {
    switch (mode) {
        case TINYGLTF_TEXTURE_WRAP_REPEAT:
            return Texture::Wrap::Repeat;
        case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
            return Texture::Wrap::MirroredRepeat;
        case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
            return Texture::Wrap::ClampToEdge;
        default:
            refuse(document_.file, "samplers[" + std::to_string(sampler) + "]." + name,
                   "10497, 33071 or 33648", std::to_string(mode));
    }
}

/// The image of glTF texture `texture` (in range), or -1. An extension's image has priority over
/// the plain one.
int TextureTable::imageOf(int texture, Warnings& warnings) const {
    const std::string place = "textures[" + std::to_string(texture) + "]";
    const nlohmann::json& json = document_.json["textures"][std::size_t(texture)];
    const nlohmann::json extensions = json.value("extensions", nlohmann::json::object());
    if (const auto webp = extensions.find("EXT_texture_webp"); webp != extensions.end()) {
        const auto source = webp->find("source");
        if (source != webp->end()) return source->get<int>();
    }
    const int source = document_.model.textures[std::size_t(texture)].source;
    warnings.add("textures without a PNG, JPEG or WebP image are left out", source < 0, place);
    warnings.add("KTX2 textures are not read: the plain images beside them are",
                 source >= 0 && extensions.contains("KHR_texture_basisu"), place);
    return source;
}

TextureUse TextureTable::request(int texture, bool srgb, Warnings& warnings) {
    const tinygltf::Texture& entry = document_.model.textures[std::size_t(texture)];
    const int image = imageOf(texture, warnings);
    if (image < 0) return {};
    Key key{image, Texture::Wrap::Repeat, Texture::Wrap::Repeat, false, srgb};
    if (entry.sampler >= 0) {
        const tinygltf::Sampler& sampler = document_.model.samplers[std::size_t(entry.sampler)];
        key.wrapU = wrap(entry.sampler, sampler.wrapS, "wrapS");
        key.wrapV = wrap(entry.sampler, sampler.wrapT, "wrapT");
        // minFilter concerns mip maps, which are not used.
        key.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    const auto [at, isNew] = known_.try_emplace(key, std::int32_t(keys_.size()));
    if (isNew) keys_.push_back(key);
    TextureUse use;
    use.value = at->second;
    return use;
}

std::vector<Texture> TextureTable::decode(Document& document) const {
    std::vector<int> images;
    for (const Key& key : keys_) images.push_back(key.image);
    std::sort(images.begin(), images.end());
    images.erase(std::unique(images.begin(), images.end()), images.end());

    std::vector<Picture> pictures(images.size());
    for (std::size_t i = 0; i < images.size(); ++i) {
        pictures[i].image = images[i];
        pictures[i].place = "images[" + std::to_string(images[i]) + "]";
        readCoded(document, pictures[i]);
        readSize(document, pictures[i]);
    }
    const auto pictureOf = [&](const Key& key) -> Picture& {
        const auto at = std::lower_bound(images.begin(), images.end(), key.image);
        return pictures[std::size_t(at - images.begin())];
    };
    std::uint64_t total = 0;
    for (const Key& key : keys_) {
        Picture& picture = pictureOf(key);
        ++picture.uses;
        takeMemory(document, picture, picture.texels() * 4);
        total += picture.texels();
    }
    if (total > Limits::kTotalTexels) {
        refuse(document.file, "textures",
               "at most " + std::to_string(Limits::kTotalTexels) + " texels in all",
               std::to_string(total), "scale the images down");
    }

    inParallel(pictures, [&](Picture& picture) { decodePicture(document, picture); });

    std::vector<Texture> textures;
    for (const Key& key : keys_) {
        Picture& picture = pictureOf(key);
        const bool isLast = --picture.uses == 0;
        textures.push_back({picture.width, picture.height,
                            isLast ? std::move(picture.rgba) : picture.rgba, key.srgb, key.wrapU,
                            key.wrapV, key.nearest});
    }
    return textures;
}

}  // namespace lacuna::gltf

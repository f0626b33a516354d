// Turns glTF's textures (image + sampler) into the description's decoded textures.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libcore/gltf/document.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// Collects the textures that the materials need: one per combination of image, wrap modes, filter and coding, however
/// many materials and glTF textures share it. An image that is used both as colour and as data becomes two textures.
class TextureTable {
  public:
    explicit TextureTable(const Document& document) : document_(document) {}

    /// Requests glTF texture `texture` (in range), read as sRGB or linear. Returns none, with a
    /// warning, where it has no readable image (only one of an unsupported extension).
    TextureUse request(int texture, bool srgb, Warnings& warnings);

    /// Reads and decodes all requested textures: images in parallel, external files in order of
    /// image number. Throws InputError for an image that is no PNG, JPEG or WebP, is damaged or is
    /// too large.
    std::vector<Texture> decode(Document& document) const;

  private:
    struct Key {
        int image;
        Texture::Wrap wrapU, wrapV;
        bool nearest, srgb;
        friend auto operator<=>(const Key&, const Key&) = default;
    };
    Texture::Wrap wrap(int sampler, int mode, const char* name) const;
    int imageOf(int texture, Warnings& warnings) const;

    const Document& document_;
    std::vector<Key> keys_;  ///< by texture index
    std::map<Key, std::int32_t> known_;
};

}  // namespace lacuna::gltf

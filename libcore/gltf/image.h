// From glTF's texture = image + sampler to the description's decoded textures.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libcore/gltf/document.h"
#include "libcore/scene/description.h"

namespace lacuna::gltf {

/// Collects which textures the materials need: one per image, wrap modes, filter and coding, however many
/// materials and glTF textures share it. An image used as colour and as data becomes two.
class TextureTable {
  public:
    explicit TextureTable(const Document& document) : document_(document) {}

    /// Index of glTF texture `texture` (in range) read as sRGB or linear; none, with a warning,
    /// where it has no image that we can read (only one of an extension).
    TextureUse request(int texture, bool srgb, Warnings& warnings);

    /// Reads and decodes all that was requested: images in parallel, external files in order of
    /// image number. Throws InputError for what is no PNG, JPEG or WebP, is damaged or is too large.
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

#include "libcore/gltf/guard.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

#include "libcore/base/text_list.h"
#include "libcore/gltf/limits.h"

namespace lacuna::gltf {
namespace {

constexpr std::array<std::string_view, 17> kSupported = {
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
};
/// Known extensions that are not read, and what is therefore lost. `loss` is empty if the picture loses nothing or
/// another warning reports it.
struct Unread {
    std::string_view name, loss;
};
constexpr std::array kUnread = {
    Unread{"EXT_lights_image_based", "name its sky by --env"},
    Unread{"EXT_texture_avif", "the plain images beside it are read"},
    Unread{"KHR_animation_pointer", ""},  // gltf.cpp warns of animations
    Unread{"KHR_materials_dispersion", "glass does not split colours"},
    Unread{"KHR_materials_iridescence", "thin films have no colours"},
    Unread{"KHR_materials_pbrSpecularGlossiness",
           "its materials get the values beside it, or become white metal"},
    Unread{"KHR_materials_unlit", "its surfaces are lit like all others"},
    Unread{"KHR_materials_variants", ""},  // the file's default variant is rendered
    Unread{"KHR_meshopt_compression", "the plain data beside it is read"},
    Unread{"KHR_texture_basisu", ""},  // image.cpp warns
    Unread{"KHR_xmp_json_ld", ""},
    Unread{"MSFT_texture_dds", "the plain images beside it are read"},
};
constexpr std::string_view kBasis = "KHR_texture_basisu", kMeshopt = "KHR_meshopt_compression";

bool isSupported(const std::string& name) {
    return std::find(kSupported.begin(), kSupported.end(), name) != kSupported.end();
}

/// Little-endian 32-bit number at `offset`, which the caller has checked.
std::uint32_t littleEndian(std::span<const std::uint8_t> bytes, std::size_t offset) {
    return std::uint32_t(bytes[offset]) | std::uint32_t(bytes[offset + 1]) << 8 |
           std::uint32_t(bytes[offset + 2]) << 16 | std::uint32_t(bytes[offset + 3]) << 24;
}

Chunks splitGlb(const std::string& file, std::span<const std::uint8_t> bytes) {
    constexpr std::uint32_t kJson = 0x4E4F534A, kBin = 0x004E4942;
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    const char* again = "copy or export the file again";
    if (bytes.size() < kHeader + kChunkHeader) {
        refuse(file, "", "a GLB header of 20 bytes", std::to_string(bytes.size()) + " bytes",
               again);
    }
    const std::uint32_t version = littleEndian(bytes, 4), length = littleEndian(bytes, 8);
    if (version != 2) refuse(file, "", "GLB version 2", std::to_string(version));
    if (length > bytes.size() || length < kHeader + kChunkHeader) {
        refuse(file, "", "a GLB of " + std::to_string(length) + " bytes, as its header says",
               std::to_string(bytes.size()), again);
    }
    const auto glb = bytes.first(length);

    Chunks chunks;
    std::size_t offset = kHeader;
    for (int index = 0; offset < glb.size(); ++index) {
        const std::size_t left = glb.size() - offset;
        if (left < kChunkHeader && index > 0) break;  // padding after the last chunk
        if (left < kChunkHeader) refuse(file, "", "a GLB chunk header", "the end", again);
        const std::uint32_t size = littleEndian(glb, offset), type = littleEndian(glb, offset + 4);
        if (size > left - kChunkHeader) {
            refuse(file, "", "at most " + std::to_string(left - kChunkHeader) + " bytes of chunk",
                   std::to_string(size), again);
        }
        const auto body = glb.subspan(offset + kChunkHeader, size);
        if (index == 0 && type != kJson) {
            refuse(file, "", "JSON as the first GLB chunk", "another type", again);
        }
        if (index == 0) {
            chunks.json = {reinterpret_cast<const char*>(body.data()), body.size()};
        } else if (index == 1 && type == kBin) {
            chunks.binary = body;
        }  // further chunks are extensions, to be skipped (glTF 2.0, 4.4.3)
        offset += kChunkHeader + size;
    }
    return chunks;
}

}  // namespace

Chunks splitContainer(const std::string& file, std::span<const std::uint8_t> bytes) {
    Chunks chunks;
    if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
        chunks = splitGlb(file, bytes);
    } else {
        chunks.json = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
        if (chunks.json.starts_with("\xEF\xBB\xBF")) chunks.json.remove_prefix(3);
        const std::size_t first = chunks.json.find_first_not_of(" \t\r\n");
        if (first == std::string_view::npos || chunks.json[first] != '{') {
            refuse(file, "", "a glTF 2.0 file (.glb or .gltf)",
                   bytes.empty() ? "an empty file" : "something else",
                   "convert the scene to glTF 2.0");
        }
    }
    if (chunks.json.size() > Limits::kJsonBytes) {
        refuse(file, "", "at most " + std::to_string(Limits::kJsonBytes) + " bytes of JSON",
               std::to_string(chunks.json.size()), "export as .glb");
    }
    return chunks;
}

void checkJsonDepth(const std::string& file, std::string_view text) {
    int depth = 0;
    bool inString = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (inString) {
            if (c == '\\') ++i;
            if (c == '"') inString = false;
        } else if (c == '"') {
            inString = true;
        } else if (c == '{' || c == '[') {
            if (++depth > Limits::kJsonDepth) {
                refuse(file, "",
                       "JSON nested at most " + std::to_string(Limits::kJsonDepth) + " deep",
                       "deeper nesting", "remove the nested extras");
            }
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
}

void checkVersionAndExtensions(const std::string& file, const nlohmann::json& root,
                               Warnings& warnings) {
    const auto asset = root.find("asset");
    const auto version =
        asset != root.end() ? asset->find("version") : nlohmann::json::const_iterator();
    if (asset == root.end() || version == asset->end()) {
        refuse(file, "asset.version", "2.0", "none", "convert the scene to glTF 2.0");
    }
    const auto& text = version->get_ref<const std::string&>();
    if (!text.starts_with("2.")) {
        refuse(file, "asset.version", "2.0", text, "convert the scene to glTF 2.0");
    }
    const std::string least = asset->value("minVersion", std::string("2.0"));
    if (least != "2.0") refuse(file, "asset.minVersion", "2.0", least);

    if (const auto required = root.find("extensionsRequired"); required != root.end()) {
        for (const auto& name : *required) {
            if (name == kBasis) {
                refuse(file, "extensionsRequired", "textures of PNG, JPEG or WebP",
                       "KTX2 (KHR_texture_basisu)",
                       "convert them with `gltf-transform ktxdecompress IN.glb OUT.glb`");
            }
            if (name == kMeshopt) {
                refuse(file, "extensionsRequired", "meshes packed by EXT_meshopt_compression",
                       "KHR_meshopt_compression",
                       "pack them with `gltfpack -c -ce ext -i IN.glb -o OUT.glb`");
            }
            if (!isSupported(name.get_ref<const std::string&>())) {
                refuse(file, "extensionsRequired", "extensions that lacuna has",
                       name.get<std::string>(), "export without it");
            }
        }
    }
    if (const auto used = root.find("extensionsUsed"); used != root.end()) {
        std::vector<std::string> unknown;
        for (const auto& entry : *used) {
            const auto& name = entry.get_ref<const std::string&>();
            const auto unread = std::find_if(kUnread.begin(), kUnread.end(),
                                             [&](const Unread& u) { return u.name == name; });
            if (unread == kUnread.end()) {
                if (!isSupported(name)) unknown.push_back(printable(name));
            } else if (!unread->loss.empty()) {
                warnings.add(name + " is not rendered: " + std::string(unread->loss), 1);
            }
        }
        if (!unknown.empty()) {
            warnings.add("extensions that are not known are ignored: " +
                             printable(joined(unknown, ", "), 400),
                         1);
        }
    }
}

}  // namespace lacuna::gltf

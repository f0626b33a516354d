// Writes small glTF assets for the tests: a JSON tree that a test edits freely, and a binary buffer
// that grows with each view. Nothing is validated: tests need wrong files too.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libcore/base/error.h"
#include "libcore/gltf/gltf.h"

namespace lacuna::test {

using nlohmann::json;
using ByteVector = std::vector<std::uint8_t>;

/// A temporary directory that is deleted at the end of the test.
class TempDir {
  public:
    TempDir() {
        std::string name = (std::filesystem::temp_directory_path() / "lacuna-gltf-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no temporary directory");
        path_ = name;
    }
    ~TempDir() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TempDir(const TempDir&) = delete;
    TempDir& operator=(const TempDir&) = delete;

    std::string write(const std::string& name, const void* data, std::size_t size) const {
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary)
            .write(static_cast<const char*>(data), std::streamsize(size));
        return file.string();
    }
    std::string write(const std::string& name, const ByteVector& bytes) const {
        return write(name, bytes.data(), bytes.size());
    }
    std::string write(const std::string& name, const std::string& text) const {
        return write(name, text.data(), text.size());
    }
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

template <class T>
ByteVector bytesOf(const std::vector<T>& values) {
    ByteVector bytes(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

std::string base64(const ByteVector& bytes);

/// PNG of `width` x `height` RGBA texels.
ByteVector png(int width, int height, const ByteVector& rgba);

/// glTF component type of a C++ type.
template <class T>
constexpr int componentType() {
    if constexpr (std::is_same_v<T, std::int8_t>) return 5120;
    if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
    if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
    if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
    if constexpr (std::is_same_v<T, std::uint32_t>) return 5125;
    if constexpr (std::is_same_v<T, float>) return 5126;
}

class GltfBuilder {
  public:
    json root = {{"asset", {{"version", "2.0"}}}};
    ByteVector binary;

    /// Appends an element to a top-level array and returns its index.
    int add(const char* array, json element) {
        root[array].push_back(std::move(element));
        return int(root[array].size()) - 1;
    }

    /// Adds a buffer view of `bytes`, aligned to 4.
    int view(const ByteVector& bytes, int stride = 0);

    /// Tightly packed accessor of `type` ("SCALAR", "VEC2", ...).
    template <class T>
    int accessor(const std::vector<T>& values, const std::string& type, bool normalized = false) {
        return accessor(bytesOf(values), componentType<T>(), values.size(), type, normalized);
    }

    /// A mesh of one primitive with these members.
    int mesh(json primitive);
    /// A node that is a root of scene 0.
    int rootNode(json node);
    /// Texture of a new image, embedded in the binary buffer.
    int texture(const ByteVector& image, json sampler = {});
    /// Scene extras.
    json& extras();

    /// A .glb of this text and this binary chunk (none if it is empty).
    static ByteVector pack(const std::string& text, const ByteVector& binary);
    /// The JSON with its one buffer declared (unless the test declares buffers itself).
    json document() const;
    ByteVector glb() const;
    SceneDescription load(LampUnits units = LampUnits::Radiometric) const;

  private:
    int accessor(const ByteVector& bytes, int componentType, std::size_t values,
                 const std::string& type, bool normalized);
};

/// One triangle (0,0,0) (1,0,0) (0,1,0) under one root node.
struct TriangleBuilder : GltfBuilder {
    int positions, meshIndex, node;
    TriangleBuilder()
        : positions(accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")),
          meshIndex(mesh({{"attributes", {{"POSITION", positions}}}})),
          node(rootNode({{"mesh", meshIndex}})) {}
    json& primitive() { return root["meshes"][0]["primitives"][0]; }
};

/// Number of warnings that contain `text`.
int warningsWith(const SceneDescription& scene, const std::string& text);

/// Expects loadGltf(path) to throw InputError with one well-formed line that contains all of
/// `parts`.
void expectRefused(const std::string& path, const std::vector<std::string>& parts);
void expectRefused(const GltfBuilder& builder, const std::vector<std::string>& parts);

/// Expects a description to have all properties on which the program relies.
void expectValid(const SceneDescription& scene);

}  // namespace lacuna::test

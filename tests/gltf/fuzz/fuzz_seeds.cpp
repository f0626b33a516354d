// fuzz_seeds DIRECTORY: writes the files that fuzzing starts from.
#include <cstdio>

#include "tests/gltf/everything.h"

using namespace lacuna::test;

namespace {

/// A triangle whose buffer, texture and environment are files beside it (fuzz_gltf.cpp has them).
std::string withFilesBesideIt() {
    TriangleBuilder b;
    b.add("images", {{"uri", "a.png"}});
    b.add("textures", {{"source", 0}});
    b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    b.primitive()["material"] = 0;
    b.add("buffers", {{"byteLength", 36}, {"uri", "a.bin"}});
    b.extras()["environment"] = {{"file", "a.hdr"}, {"scale", 2}, {"rotation_degrees", 90}};
    return b.root.dump();
}

/// Everything as JSON alone.
std::string withDataUris() {
    const GltfBuilder b = everything();
    json document = b.document();
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(b.binary);
    return document.dump();
}

void write(const std::filesystem::path& file, const void* data, std::size_t size) {
    std::ofstream stream(file, std::ios::binary);
    stream.write(static_cast<const char*>(data), std::streamsize(size));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: fuzz_seeds DIRECTORY\n");
        return 2;
    }
    const std::filesystem::path directory = argv[1];
    std::filesystem::create_directories(directory);
    const auto text = [&](const char* name, const std::string& json) {
        write(directory / name, json.data(), json.size());
    };
    const auto binary = [&](const char* name, const ByteVector& bytes) {
        write(directory / name, bytes.data(), bytes.size());
    };
    binary("triangle.glb", TriangleBuilder().glb());
    text("triangle.gltf", TriangleBuilder().document().dump());
    binary("everything.glb", everything().glb());
    text("data-uris.gltf", withDataUris());
    text("files.gltf", withFilesBesideIt());
}

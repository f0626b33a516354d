// Containers, external files, data URIs and the content hash.
#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {
namespace {

/// The JSON of `b` with its one buffer at `uri`.
std::string textWithBuffer(const GltfBuilder& b, const std::string& uri) {
    json document = b.document();
    document["buffers"][0]["uri"] = uri;
    return document.dump();
}

/// A triangle whose material shows a 1 x 1 image at `uri`.
TriangleBuilder withImageAt(const std::string& uri) {
    TriangleBuilder b;
    b.add("textures", {{"source", b.add("images", {{"uri", uri}})}});
    b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    return b;
}

const ByteVector kTexel = {10, 20, 30, 40};

TEST(Files, GltfWithExternalFiles) {
    const TempDir dir;
    const TriangleBuilder b = withImageAt("maps/wood%20grain.png");
    dir.write("data/mesh.bin", b.binary);
    dir.write("maps/wood grain.png", png(1, 1, kTexel));
    const SceneDescription scene =
        loadGltf(dir.write("scene.gltf", textWithBuffer(b, "data/mesh.bin")));
    expectValid(scene);
    EXPECT_EQ(scene.meshes[0].positions[1], Vec3(1, 0, 0));
    EXPECT_EQ(scene.textures[0].rgba, kTexel);
}

TEST(Files, GltfWithDataUris) {
    const TempDir dir;
    const TriangleBuilder b = withImageAt("data:image/png;base64," + base64(png(1, 1, kTexel)));
    for (const char* type : {"application/octet-stream", "application/gltf-buffer", ""}) {
        const std::string uri = std::string("data:") + type + ";base64," + base64(b.binary);
        const SceneDescription scene = loadGltf(dir.write("scene.gltf", textWithBuffer(b, uri)));
        EXPECT_EQ(scene.meshes[0].positions[2], Vec3(0, 1, 0));
        EXPECT_EQ(scene.textures[0].rgba, kTexel);
    }
}

// Two texels each, written by zlib and the PNG specification, without a library for PNG.
TEST(Files, PngOfEveryKind) {
    const struct {
        const char *kind, *base64;
        ByteVector texels;
    } kPictures[] = {
        {"grey, 1 bit",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABAQAAAADcWUInAAAACklEQVR42mNwAAAAQgBBhL+OYgAA"
         "AABJRU5ErkJggg==",
         {0, 0, 0, 255, 255, 255, 255, 255}},
        {"grey, 4 bits",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABBAAAAAAUuc1XAAAACklEQVR42mOwAQAAPgA9h6ZubwAA"
         "AABJRU5ErkJggg==",
         {51, 51, 51, 255, 204, 204, 204, 255}},
        {"grey",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAAAAADRSSBWAAAAC0lEQVR42mNgPwEAANkA0EQCVdsA"
         "AAAASUVORK5CYII=",
         {7, 7, 7, 255, 200, 200, 200, 255}},
        {"grey, 16 bits",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABEAAAAACB2fwVAAAADUlEQVR42mNgZzzBBAABtgDTcXTS"
         "CAAAAABJRU5ErkJggg==",
         {7, 7, 7, 255, 200, 200, 200, 255}},
        {"grey, one of which is clear",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAAAAADRSSBWAAAAAnRSTlMAB+j3WJsAAAALSURBVHja"
         "Y2A/AQAA2QDQRAJV2wAAAABJRU5ErkJggg==",
         {7, 7, 7, 0, 200, 200, 200, 255}},
        {"grey and alpha",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAQAAABeK7cBAAAADUlEQVR42mNgTzlhBAADDwFmhYBU"
         "7wAAAABJRU5ErkJggg==",
         {7, 7, 7, 100, 200, 200, 200, 50}},
        {"palette",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAMAAADD/I+4AAAABlBMVEUKFB4oMjzVG7TpAAAAC0lE"
         "QVR42mNgZAAAAAUAAkLCRJ8AAAAASUVORK5CYII=",
         {40, 50, 60, 255, 10, 20, 30, 255}},
        {"palette with alpha",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAMAAADD/I+4AAAABlBMVEUKFB4oMjzVG7TpAAAAAXRS"
         "TlNNSIvlSwAAAAtJREFUeNpjYGQAAAAFAAJCwkSfAAAAAElFTkSuQmCC",
         {40, 50, 60, 255, 10, 20, 30, 77}},
        {"RGB",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR42mNgZGJmYWUDAAA/ABaY"
         "wWgTAAAAAElFTkSuQmCC",
         {1, 2, 3, 255, 4, 5, 6, 255}},
        {"RGB, one of which is clear",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAABnRSTlMAAQACAAPJS6v1AAAAD0lE"
         "QVR42mNgZGJmYWUDAAA/ABaYwWgTAAAAAElFTkSuQmCC",
         {1, 2, 3, 0, 4, 5, 6, 255}},
        {"RGB, 16 bits",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABEAIAAAAr0DSeAAAAFUlEQVR42mNgYGRiZmFlY+fg5OIG"
         "AAErAEOd+M8cAAAAAElFTkSuQmCC",
         {0, 2, 4, 255, 6, 8, 10, 255}},
        {"RGBA",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEUlEQVR42mNgZGJmYWVj5wAAAIEA"
         "JeWaT4EAAAAASUVORK5CYII=",
         {1, 2, 3, 4, 5, 6, 7, 8}},
        {"RGBA, 16 bits",
         "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABEAYAAACksqPJAAAAGUlEQVR42mNgYGRiZmFlY+fg5OLm"
         "4eXjBwACuQB5Wm3WCQAAAABJRU5ErkJggg==",
         {0, 2, 4, 6, 8, 10, 12, 14}},
    };
    const TempDir dir;
    for (const auto& picture : kPictures) {
        SCOPED_TRACE(picture.kind);
        const TriangleBuilder b =
            withImageAt(std::string("data:image/png;base64,") + picture.base64);
        const SceneDescription scene = loadGltf(dir.write("scene.glb", b.glb()));
        EXPECT_EQ(scene.textures[0].rgba, picture.texels);
    }
}

TEST(Files, Base64OfEveryLengthAndByte) {
    const TempDir dir;
    for (std::size_t extra = 0; extra < 4; ++extra) {
        TriangleBuilder b;
        std::vector<std::uint8_t> bytes(765 + extra, 0);  // 3-byte positions: every byte value
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(i * 7 + i / 256);
        b.primitive()["attributes"]["POSITION"] =
            b.accessor<std::uint8_t>({bytes.begin(), bytes.begin() + 765}, "VEC3");
        b.view(ByteVector(bytes.begin() + 765, bytes.end()));
        const std::string uri = "data:application/octet-stream;base64," + base64(b.binary);
        const Mesh inText = loadGltf(dir.write("a.gltf", textWithBuffer(b, uri))).meshes[0];
        EXPECT_EQ(inText.positions, b.load().meshes[0].positions);
    }
}

TEST(Files, GlbWithASecondExternalBuffer) {
    const TempDir dir;
    TriangleBuilder b;
    b.root["buffers"] = {{{"byteLength", b.binary.size()}}, {{"byteLength", 6}, {"uri", "i.bin"}}};
    b.add("bufferViews", {{"buffer", 1}, {"byteLength", 6}});
    b.primitive()["indices"] =
        b.add("accessors",
              {{"bufferView", 1}, {"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}});
    dir.write("i.bin", bytesOf<std::uint16_t>({1, 2, 0}));
    const SceneDescription scene = loadGltf(dir.write("scene.glb", b.glb()));
    EXPECT_EQ(scene.meshes[0].triangles[0], (std::array<std::uint32_t, 3>{1, 2, 0}));
}

TEST(Files, ContentDecidesNotTheName) {
    const TempDir dir;
    const TriangleBuilder b;
    EXPECT_NO_THROW(loadGltf(dir.write("scene.gltf", b.glb())));
    const std::string uri = "data:;base64," + base64(b.binary);
    EXPECT_NO_THROW(loadGltf(dir.write("scene.glb", "\xEF\xBB\xBF \n" + textWithBuffer(b, uri))));
}

TEST(Files, UnsafeUrisAreRefusedAndNotRead) {
    const TempDir dir;
    const TriangleBuilder b;
    dir.write("mesh.bin", b.binary);
    const std::string absolute = dir / "mesh.bin";
    for (const std::string& uri :
         {std::string("../mesh.bin"), std::string("sub/../../mesh.bin"), std::string("sub/.."),
          std::string("%2e%2e/mesh.bin"), std::string("..%2Fmesh.bin"), std::string("..\\mesh.bin"),
          absolute, std::string("%2Fetc/passwd"), "file://" + absolute,
          std::string("http://example.org/mesh.bin"), std::string("C:/mesh.bin"),
          std::string("C:\\mesh.bin"), std::string("\\mesh.bin"), std::string(""),
          std::string("mesh.bin%00.png"), std::string("a\nb"), std::string("DATA:,x")}) {
        SCOPED_TRACE(uri);
        expectRefused(dir.write("sub/scene.gltf", textWithBuffer(b, uri)),
                      {"scene.gltf", "buffers[0]", "in the scene's folder"});
        TriangleBuilder image = withImageAt(uri);
        expectRefused(dir.write("sub/scene.glb", image.glb()), {"images[0]"});
    }
    EXPECT_NO_THROW(loadGltf(dir.write("scene.gltf", textWithBuffer(b, "./mesh.bin"))));
}

TEST(Files, BadDataUrisAreRefused) {
    const TempDir dir;
    const TriangleBuilder b;
    const std::string good = base64(b.binary);
    for (const std::string& uri :
         {std::string("data:"), std::string("data:,"), std::string("data:;base64,"),
          std::string("data:application/octet-stream,") + good,
          std::string("data:;base64,") + good.substr(0, 10), "data:;base64,*" + good.substr(1),
          std::string("data:;base64,A"),
          "data:;base64," + good.substr(0, 8) + "\n" + good.substr(9),
          "data:;base64,====" + good}) {
        SCOPED_TRACE(uri);
        expectRefused(dir.write("scene.gltf", textWithBuffer(b, uri)), {"buffers[0]"});
    }
}

TEST(Files, MissingAndShortExternalFiles) {
    const TempDir dir;
    const TriangleBuilder b;
    const std::string path = dir.write("scene.gltf", textWithBuffer(b, "mesh.bin"));
    expectRefused(path, {"mesh.bin", "named by", "buffers[0]", "none"});
    ByteVector shorter = b.binary;
    shorter.pop_back();
    dir.write("mesh.bin", shorter);
    expectRefused(path, {"buffers[0]", "36 bytes", "found 35"});
    dir.write("mesh.bin", b.binary);
    EXPECT_NO_THROW(loadGltf(path));
    expectRefused(dir.write("folder.gltf", textWithBuffer(b, ".")), {"directory"});
    expectRefused(dir.write("a.glb", withImageAt("none.png").glb()), {"none.png", "images[0]"});
}

TEST(Files, WhatIsNoFileIsRefused) {
    const TempDir dir;
    expectRefused(dir / "none.glb", {"none.glb", "none"});
    expectRefused(dir / "", {"a directory"});
    expectRefused("/dev/null", {"regular file"});
    expectRefused(dir.write("empty.glb", std::string()), {"empty file"});
    expectRefused(dir.write("blank.gltf", std::string("  \n ")), {"glTF"});
    expectRefused(dir.write("text.gltf", std::string("# Wavefront OBJ")), {"glTF 2.0"});
    expectRefused(dir.write("list.gltf", std::string("[1, 2]")), {"glTF 2.0"});
    expectRefused(dir.write("json.gltf", std::string("{\"asset\": ")), {"valid JSON"});
    expectRefused(dir.write("none.gltf", std::string("{}")), {"asset.version", "none"});
    expectRefused(dir.write("old.gltf", std::string(R"({"asset": {"version": "1.0"}})")), {"1.0"});
    expectRefused(
        dir.write("new.gltf", std::string(R"({"asset": {"version": "2.1", "minVersion": "2.1"}})")),
        {"minVersion"});
    EXPECT_NO_THROW(
        loadGltf(dir.write("bare.gltf", std::string(R"({"asset": {"version": "2.0"}})"))));
}

TEST(Files, GlbHeadersAreChecked) {
    const TempDir dir;
    const ByteVector good = TriangleBuilder().glb();
    const auto edited = [&](std::size_t at, std::uint32_t value) {
        ByteVector bytes = good;
        std::memcpy(&bytes[at], &value, 4);
        return dir.write("scene.glb", bytes);
    };
    expectRefused(edited(4, 1), {"GLB version 2"});
    expectRefused(edited(8, std::uint32_t(good.size() + 1)), {"as its header says"});
    expectRefused(edited(8, 12), {"header"});
    expectRefused(edited(12, std::uint32_t(good.size())), {"chunk"});
    expectRefused(edited(12, 0xFFFFFFFFu), {"chunk"});
    expectRefused(edited(16, 0x004E4942), {"JSON as the first"});
    ByteVector trailing = good;
    trailing.insert(trailing.end(), 100, 0xAA);  // behind the length in the header
    EXPECT_NO_THROW(loadGltf(dir.write("scene.glb", trailing)));
}

TEST(Files, HashCoversEveryFileThatWasRead) {
    const TempDir dir;
    TriangleBuilder b = withImageAt("a.png");
    b.extras()["environment"] = "sky.hdr";
    dir.write("mesh.bin", b.binary);
    dir.write("a.png", png(1, 1, kTexel));
    dir.write("sky.hdr", std::string("one"));
    const std::string path = dir.write("scene.gltf", textWithBuffer(b, "mesh.bin"));
    const std::string first = loadGltf(path).contentHash;
    EXPECT_EQ(first.find_first_not_of("0123456789abcdef"), std::string::npos);
    EXPECT_EQ(loadGltf(path).contentHash, first);

    dir.write("sky.hdr", std::string("two"));
    EXPECT_NE(loadGltf(path).contentHash, first);
    dir.write("sky.hdr", std::string("one"));
    EXPECT_EQ(loadGltf(path).contentHash, first);
    dir.write("a.png", png(1, 1, {1, 2, 3, 4}));
    EXPECT_NE(loadGltf(path).contentHash, first);
    dir.write("a.png", png(1, 1, kTexel));
    ByteVector other = b.binary;
    other[2] ^= 1;
    dir.write("mesh.bin", other);
    EXPECT_NE(loadGltf(path).contentHash, first);
    dir.write("mesh.bin", b.binary);
    EXPECT_EQ(loadGltf(path).contentHash, first);
    std::filesystem::copy(path, dir / "copy.gltf");
    EXPECT_EQ(loadGltf(dir / "copy.gltf").contentHash, first);
    dir.write("scene.gltf", textWithBuffer(b, "mesh.bin") + " ");
    EXPECT_NE(loadGltf(path).contentHash, first);
}

TEST(Files, HashIsXxh3) {
    const TempDir dir;
    // XXH3-128 of these 29 bytes, canonical form, by xxhash's one-shot function.
    const std::string path = dir.write("a.gltf", std::string(R"({"asset": {"version": "2.0"}})"));
    EXPECT_EQ(loadGltf(path).contentHash, "4b07960ed3763ac4afff1fbb880b8556");
}

}  // namespace
}  // namespace lacuna::test

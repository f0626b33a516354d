// EXT_texture_webp and what becomes of KHR_texture_basisu.
#include "tests/gltf/everything.h"
#include "tests/gltf/packed.h"

namespace lacuna::test {
namespace {

ByteVector someTexels(int width, int height) {
    ByteVector texels;
    for (int i = 0; i < width * height; ++i) {
        texels.insert(texels.end(), {std::uint8_t(7 * i), std::uint8_t(255 - i),
                                     std::uint8_t(i * i), std::uint8_t(i % 5 ? 255 : 40 + i)});
    }
    return texels;
}

/// A triangle with one texture, which has no plain image.
TriangleBuilder withWebp(const ByteVector& image) {
    TriangleBuilder b;
    const int index = b.add("images", {{"bufferView", b.view(image)}, {"mimeType", "image/webp"}});
    b.add("textures", {{"extensions", {{"EXT_texture_webp", {{"source", index}}}}}});
    b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    b.primitive()["material"] = 0;
    b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"EXT_texture_webp"};
    return b;
}

TEST(Webp, TexelsAreThoseThatWerePacked) {
    const ByteVector texels = someTexels(6, 5);
    const SceneDescription scene = withWebp(webp(6, 5, texels)).load();
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].width, 6);
    EXPECT_EQ(scene.textures[0].rgba, texels);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Webp, GoesBeforeThePlainImage) {
    const ByteVector texels = someTexels(2, 2);
    TriangleBuilder b = withWebp(webp(2, 2, texels));
    b.texture(png(1, 1, {1, 2, 3, 255}));
    b.root["textures"][0]["source"] = 1;
    EXPECT_EQ(b.load().textures[0].rgba, texels);
    // An image may be WebP without the extension, too, which others read as well.
    b.root["textures"][0] = {{"source", 0}};
    EXPECT_EQ(b.load().textures[0].rgba, texels);
}

TEST(Webp, DamagedOnesAreReadOrRefused) {
    const TempDir dir;
    const ByteVector whole = webp(6, 5, someTexels(6, 5));
    for (std::size_t i = 0; i < whole.size(); ++i) {
        for (const std::uint8_t change : {0x01, 0x80, 0xFF}) {
            ByteVector damaged = whole;
            damaged[i] ^= change;
            loadsOrIsRefused(dir, withWebp(damaged).glb());
        }
        // Padding at the end may go.
        const ByteVector cut(whole.begin(), whole.begin() + std::ptrdiff_t(i));
        EXPECT_TRUE(!loadsOrIsRefused(dir, withWebp(cut).glb()) || i + 2 > whole.size()) << i;
    }
    expectRefused(withWebp({'R', 'I', 'F', 'F', 0, 0, 0, 0, 'W', 'E', 'B', 'P', 0}),
                  {"images[0]", "damaged header"});
}

TEST(Webp, FlatPicturesMayNotTakeAllMemory) {
    // 16,384 x 16,384 texels of one colour take 2 GB to decode; the file has a few dozen bytes.
    ByteVector flat = webp(1, 1, {9, 9, 9, 255});
    for (const std::size_t i : {21, 22, 23}) flat[i] = 0xFF;
    flat[24] |= 0x0F;
    expectRefused(withWebp(flat), {"images[0]", "4096 times the file's bytes"});
}

TEST(Basisu, RequiredIsRefusedWithAConverter) {
    TriangleBuilder b;
    b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"KHR_texture_basisu"};
    expectRefused(
        b, {"extensionsRequired", "KTX2 (KHR_texture_basisu)", "gltf-transform ktxdecompress"});
}

TEST(Basisu, ThePlainImageBesideItIsTaken) {
    TriangleBuilder b = withWebp(webp(1, 1, {1, 2, 3, 255}));
    b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"KHR_texture_basisu"};
    b.root.erase("extensionsRequired");
    b.root["textures"][0] = {{"source", 0},
                             {"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
    const SceneDescription scene = b.load();
    EXPECT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(warningsWith(scene, "KTX2 textures are not read"), 1);
    EXPECT_EQ(warningsWith(scene, "extensions that are not known"), 0);
    b.root["textures"][0].erase("source");
    EXPECT_EQ(warningsWith(b.load(), "without a PNG, JPEG or WebP image"), 1);
}

}  // namespace
}  // namespace lacuna::test

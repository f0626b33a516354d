#include "libcore/image/cryptomatte.h"

#include <bit>
#include <cmath>

#include "tests/image/test_files.h"

namespace lacuna {
namespace {

/// Published hashes whose exponent is an ordinary one; the first two are in Cryptomatte's specification.
TEST(Cryptomatte, HashesAsEverybodyDoes) {
    EXPECT_EQ(cryptomatteBits("bunny"), 0x13851a76u);
    EXPECT_EQ(cryptomatteBits("default"), 0x42c9679fu);
    EXPECT_EQ(cryptomatteBits("test"), 0xba6bd213u);
    EXPECT_EQ(cryptomatteBits("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
    EXPECT_EQ(cryptomatteBits("Hello, world!"), 0xc0363e43u);
}

/// Hashes with an exponent of 0 or 255 would be denormal, infinite or no number. That of "" is 0.
TEST(Cryptomatte, IdsAreNumbers) {
    EXPECT_EQ(cryptomatteBits(""), 0x00800000u);
    for (int i = 0; i < 20000; ++i) {
        EXPECT_TRUE(std::isnormal(std::bit_cast<float>(cryptomatteBits(std::to_string(i))))) << i;
    }
}

TEST(Cryptomatte, LayersHoldTwoRanksEach) {
    LayeredImage image(2, 1);
    Matte matte{"CryptoObject", {"a \"quoted\" name", "bunny", "\xc3\xa4"}, {}};
    matte.pixels.resize(2);
    matte.pixels[0] = {{{1, 0.5f}, {0, 0.25f}, {2, 0.125f}, {}, {}, {}}};
    addCryptomatte(image, matte);
    EXPECT_EQ(image.channels().size(), 12u);
    const auto bunny = std::bit_cast<float>(0x13851a76u);
    EXPECT_EQ(*image.find("CryptoObject00.R"), (std::vector<float>{bunny, 0}));
    EXPECT_EQ(*image.find("CryptoObject00.G"), (std::vector<float>{0.5f, 0}));
    EXPECT_EQ(image.find("CryptoObject00.B")->front(),
              std::bit_cast<float>(cryptomatteBits(matte.names[0])));
    EXPECT_EQ(image.find("CryptoObject00.A")->front(), 0.25f);
    EXPECT_EQ(image.find("CryptoObject01.G")->front(), 0.125f);
    EXPECT_EQ(image.find("CryptoObject02.G")->front(), 0.0f);
    // The key is from the type's hash, 3ae39a58; the keys in the specification are examples.
    const std::string key = "cryptomatte/3ae39a5/";
    const auto text = [&](const char* name) {
        return std::get<std::string>(image.attributes.at(key + name));
    };
    EXPECT_EQ(text("name"), "CryptoObject");
    EXPECT_EQ(text("hash"), "MurmurHash3_32");
    EXPECT_EQ(text("conversion"), "uint32_to_float32");
    const std::string manifest = text("manifest");
    EXPECT_NE(manifest.find("\"bunny\":\"13851a76\""), std::string::npos) << manifest;
    EXPECT_NE(manifest.find(R"("a \"quoted\" name":")"), std::string::npos) << manifest;
    EXPECT_NE(manifest.find("\"\xc3\xa4\":"), std::string::npos) << manifest;

    const LayeredImage shown = cryptomattePictures(image);
    EXPECT_TRUE(shown.hasRgb("CryptoObject"));
    EXPECT_GT(shown.find("CryptoObject.R")->at(0), 0.0f);
    EXPECT_EQ(shown.find("CryptoObject.R")->at(1), 0.0f);
    matte.pixels.resize(3);
    EXPECT_THROW(addCryptomatte(image, matte), std::invalid_argument);
}

}  // namespace
}  // namespace lacuna

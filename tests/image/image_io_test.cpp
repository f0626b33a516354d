// PNG, PFM and HDR: round trips, files by hand, damage.
#include "libcore/image/image_io.h"

#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <limits>

#include "tests/image/test_files.h"

namespace lacuna {
namespace {

using test::messageOf;

class ImageIo : public test::FileTest {
  protected:
    /// Cuts the file `name` and flips its bits: nothing but an InputError or an image may come of
    /// it.
    void damage(const std::string& name, bool truncationIsAlwaysFound) {
        const test::Bytes whole = test::slurp(path(name));
        const std::string broken = path("broken" + endingOf(name));
        for (std::size_t n = 0; n < whole.size(); n += 1 + n / 100) {
            test::spill(broken, test::Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(n)));
            try {
                readImage(broken);
                EXPECT_FALSE(truncationIsAlwaysFound) << n << " of " << whole.size();
            } catch (const InputError&) {
            }
        }
        std::mt19937 random(3);
        for (int i = 0; i < 500; ++i) {
            test::Bytes bytes = whole;
            const std::size_t range =
                i % 2 ? bytes.size() : std::min<std::size_t>(80, bytes.size());
            bytes[random() % range] ^= char(1u << (random() % 8));
            test::spill(broken, bytes);
            try {
                const Image image = readImage(broken);
                EXPECT_EQ(image.pixels.size(), std::size_t(image.width) * image.height);
            } catch (const InputError& e) {
                EXPECT_EQ(std::string(e.what()).rfind(broken + ": ", 0), 0u) << e.what();
            }
        }
    }

    void writeHdr(const std::string& name, const Image& image) {
        ASSERT_TRUE(
            stbi_write_hdr(path(name).c_str(), image.width, image.height, 3, &image.pixels[0].r));
    }
};

TEST_F(ImageIo, PfmKeepsEveryBit) {
    Image image(7, 5);
    const auto values = test::randomFloats(image.pixels.size() * 3, 5);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    }
    image.at(3, 3) = Rgb(std::numeric_limits<float>::infinity());
    writeImage(path("a.pfm"), test::layered(image));
    const Image read = readImage(path("a.pfm"));
    ASSERT_EQ(read.width, 7);
    ASSERT_EQ(read.pixels.size(), image.pixels.size());
    EXPECT_EQ(std::memcmp(read.pixels.data(), image.pixels.data(), 12 * read.pixels.size()), 0);
}

TEST_F(ImageIo, PfmByHand) {
    // Grey, big-endian, bottom row first: 1 below, 2 above.
    test::spill(path("a.pfm"), std::string("Pf 1 2 1.0\n\x3f\x80\0\0\x40\0\0\0", 19));
    EXPECT_EQ(readImage(path("a.pfm")).pixels, (std::vector<Rgb>{Rgb(2), Rgb(1)}));
    // The first float may look like white space.
    test::spill(path("a.pfm"), std::string("Pf\n1 1\n-1\n\n\n\n\n", 14));
    EXPECT_EQ(readImage(path("a.pfm")).pixels[0], Rgb(std::bit_cast<float>(0x0a0a0a0au)));
    for (const char* text : {"PF", "PX 1 1 -1\n", "PF 1 1 0\n", "PF -1 1 -1\n", "PF 1x 1 -1\n",
                             "PF 99999 1 -1\n", "PF 60000 60000 -1\n", "PF 1 1 -1\nshort"}) {
        test::spill(path("a.pfm"), std::string(text));
        EXPECT_THROW(readImage(path("a.pfm")), InputError) << text;
    }
}

TEST_F(ImageIo, PngIsSrgbAfterExposure) {
    Image image(4, 1);
    image.at(0, 0) = {0.0f, 1.0f, 0.5f};
    image.at(1, 0) = {0.25f, 0.001f, 7.0f};
    image.at(2, 0) = {-1.0f, std::numeric_limits<float>::quiet_NaN(),
                      std::numeric_limits<float>::infinity()};
    image.at(3, 0) = Rgb(0.18f);
    const auto code = [](float linear) { return std::lround(255 * linear); };
    writeImage(path("a.png"), test::layered(image));
    const Image read = readImage(path("a.png"));
    EXPECT_EQ(read.at(0, 0).r, 0.0f);
    EXPECT_EQ(read.at(0, 0).g, 1.0f);
    EXPECT_EQ(code(read.at(0, 0).b), code(0.5029f));  // 0.5 is code 188, which is 0.50289
    EXPECT_EQ(read.at(1, 0).b, 1.0f);
    EXPECT_EQ(read.at(2, 0), Rgb(0, 0, 1));
    EXPECT_NEAR(read.at(3, 0).r, 0.18116f, 1e-5);  // code 118
    writeImage(path("b.png"), test::layered(image), PngStyle{.exposure = 2.0});
    EXPECT_EQ(readImage(path("b.png")).at(1, 0).r, 1.0f);
    EXPECT_NEAR(readImage(path("b.png")).at(1, 0).g, 0.004f, 4e-4);
    writeImage(path("c.png"), test::layered(image), PngStyle{.exposure = -1.0});
    EXPECT_NEAR(readImage(path("c.png")).at(0, 0).g, 0.5029f, 1e-4);
}

TEST_F(ImageIo, PngCodesSurvive) {
    std::vector<std::uint8_t> bytes(16 * 16 * 3);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(i / 3 + 85 * (i % 3));
    writePngBytes(path("a.png"), 16, 16, bytes);
    writeImage(path("b.png"), test::layered(readImage(path("a.png"))));
    EXPECT_EQ(test::slurp(path("a.png")), test::slurp(path("b.png")));
    EXPECT_THROW(writePngBytes(path("c.png"), 16, 15, bytes), std::invalid_argument);
}

TEST_F(ImageIo, PngOfSixteenBits) {
    Image image(257, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const float v = float(i) / float(image.pixels.size());
        image.pixels[i] = {v, v * v, 1.0f - v};
    }
    const Image back = [&] {
        writeImage(path("a.png"), test::layered(image), PngStyle{.bits = 16});
        return readImage(path("a.png"));
    }();
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        EXPECT_NEAR(back.pixels[i].r, image.pixels[i].r, 2e-5f);
        EXPECT_NEAR(back.pixels[i].g, image.pixels[i].g, 2e-5f);
        EXPECT_NEAR(back.pixels[i].b, image.pixels[i].b, 2e-5f);
    }
    EXPECT_TRUE(isOurPng(path("a.png")));
    EXPECT_THROW(writePngBytes(path("c.png"), 1, 1, {1, 2, 3, 4, 5, 6}, 12), std::invalid_argument);
}

/// The picture's colours are premultiplied, those of a .png are not.
TEST_F(ImageIo, PngWithAlphaHasStraightColours) {
    LayeredImage image = test::layered(Image(3, 1, Rgb(0.25f)));
    image.channel("A") = {1.0f, 0.5f, 0.0f};
    for (const int bits : {8, 16}) {
        writeImage(path("a.png"), image, PngStyle{.bits = bits});
        int width = 0, height = 0, channels = 0;
        std::uint8_t* at = stbi_load(path("a.png").c_str(), &width, &height, &channels, 0);
        ASSERT_NE(at, nullptr);
        EXPECT_EQ(channels, 4);
        EXPECT_EQ((std::vector<int>{at[0], at[3], at[4], at[7], at[8], at[11]}),
                  (std::vector<int>{137, 255, 188, 128, 0, 0}));
        stbi_image_free(at);
        EXPECT_TRUE(isOurPng(path("a.png")));
        EXPECT_EQ(readImage(path("a.png")).width, 3);
    }
}

/// Lengths and checksums, which stb_image does not look at; also where the pixels take many chunks.
TEST_F(ImageIo, PngChunksAreIntact) {
    for (const int bits : {8, 16}) {
        writeImage(path("a.png"), test::layered(test::randomImage(301, 200, 3)),
                   PngStyle{.bits = bits});
        const test::Bytes bytes = test::slurp(path("a.png"));
        const auto at = [&](std::size_t i) {
            std::uint32_t value = 0;
            for (std::size_t k = 0; k < 4; ++k) value = value << 8 | std::uint8_t(bytes[i + k]);
            return value;
        };
        std::vector<std::string> types;
        std::size_t i = 8;
        while (i + 12 <= bytes.size()) {
            const std::uint32_t length = at(i);
            ASSERT_LE(i + 12 + length, bytes.size());
            types.emplace_back(&bytes[i + 4], 4);
            EXPECT_EQ(at(i + 8 + length),
                      crc32(0, reinterpret_cast<const Bytef*>(&bytes[i + 4]), 4 + length));
            i += 12 + length;
        }
        EXPECT_EQ(i, bytes.size());
        ASSERT_GT(types.size(), 4u);
        EXPECT_EQ(types[0], "IHDR");
        EXPECT_EQ(types[1], "tEXt");
        EXPECT_EQ(types[3], "IDAT");
        EXPECT_EQ(types.back(), "IEND");
    }
}

TEST_F(ImageIo, HdrWithinItsPrecision) {
    for (const auto& [width, height] : {std::pair(40, 11), std::pair(5, 3)}) {  // RLE, flat
        const Image image = test::randomImage(width, height, 9);
        writeHdr("a.hdr", image);
        const Image read = readImage(path("a.hdr"));
        ASSERT_EQ(read.width, width);
        ASSERT_EQ(read.height, height);
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            const float step = maxComponent(image.pixels[i]) / 128;
            EXPECT_NEAR(read.pixels[i].r, image.pixels[i].r, step);
            EXPECT_NEAR(read.pixels[i].g, image.pixels[i].g, step);
            EXPECT_NEAR(read.pixels[i].b, image.pixels[i].b, step);
        }
    }
}

TEST_F(ImageIo, HdrByHand) {
    const std::string header = "#?RADIANCE\n# remark\nFORMAT=32-bit_rle_rgbe\n\n";
    test::spill(path("a.hdr"),
                header + std::string("-Y 1 +X 2\n\x80\x40\x20\x81\xff\xff\xff\0", 18));
    EXPECT_EQ(readImage(path("a.hdr")).pixels, (std::vector<Rgb>{{1.0f, 0.5f, 0.25f}, {}}));
    // A literal of length 0 is what stb_image loops on.
    const std::string rle = header + "-Y 1 +X 8\n" + std::string("\x02\x02\x00\x08", 4);
    const std::string run = std::string("\x88\x80", 2);
    test::spill(path("a.hdr"), rle + run + run + run + "\x88\x81");
    EXPECT_EQ(readImage(path("a.hdr")).pixels, std::vector<Rgb>(8, Rgb(1)));
    for (const std::string& text :
         {rle + run + std::string(20, '\0'), rle + "\x89\x80" + run + run + run,
          header + std::string("-Y 1 +X 9\n\x02\x02\x00\x08", 14) + run + run + run + run,
          header + "+X 1 -Y 1\nabcd", header + "-Y 99999 +X 1\n",
          std::string("#?RADIANCE\n\n-Y 1 +X 1\nabcd")}) {
        test::spill(path("a.hdr"), text);
        EXPECT_THROW(readImage(path("a.hdr")), InputError) << text;
    }
}

TEST_F(ImageIo, DamagedFiles) {
    const Image image = test::randomImage(40, 11, 2);
    writeImage(path("a.png"), test::layered(image));
    writeImage(path("a.pfm"), test::layered(image));
    writeHdr("a.hdr", image);
    damage("a.pfm", true);
    damage("a.hdr", true);
    damage("a.png", false);  // only a checksum may be missing
}

// Without the check, memory for all pixels that a header claims would be taken before anyone looks
// for them.
TEST_F(ImageIo, HeadersThatClaimMoreThanThereIs) {
    writeImage(path("a.png"), test::layered(test::randomImage(40, 11, 2)));
    test::Bytes bytes = test::slurp(path("a.png"));
    for (const std::size_t side : {16u, 20u}) bytes[side + 2] = 32;  // 8232 x 8203
    test::spill(path("b.png"), bytes);
    EXPECT_NE(messageOf<InputError>([&] { readImage(path("b.png")); }).find("so large a picture"),
              std::string::npos);
    bytes = test::slurp(path("a.png"));
    const std::string all(bytes.begin(), bytes.end());
    bytes[all.find("IDAT") - 4] = 32;  // a chunk of half a gigabyte
    test::spill(path("b.png"), bytes);
    EXPECT_NE(messageOf<InputError>([&] { readImage(path("b.png")); }).find("beyond the file"),
              std::string::npos);
    test::spill(path("b.png"), all + "what others put behind the last chunk");
    EXPECT_EQ(readImage(path("b.png")).pixels, readImage(path("a.png")).pixels);
    const std::string claim = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n\2\2";
    test::spill(path("b.hdr"), claim);
    EXPECT_NE(messageOf<InputError>([&] { readImage(path("b.hdr")); }).find("more pixels"),
              std::string::npos);
}

/// A PNG of one bit per pixel, all of them black.
test::Bytes blackBits(std::uint32_t side) {
    const auto number = [](std::uint32_t value) {
        std::string text;
        for (int shift = 24; shift >= 0; shift -= 8) text += char(value >> shift);
        return text;
    };
    const auto chunk = [&](const std::string& named) {
        const auto* from = reinterpret_cast<const Bytef*>(named.data());
        return number(std::uint32_t(named.size() - 4)) + named +
               number(std::uint32_t(crc32(0, from, uInt(named.size()))));
    };
    const std::vector<Bytef> rows(std::size_t(side) * (1 + (side + 7) / 8));
    uLongf size = compressBound(rows.size());
    std::string packed(size, '\0');
    compress2(reinterpret_cast<Bytef*>(packed.data()), &size, rows.data(), rows.size(), 9);
    packed.resize(size);
    const std::string file =
        "\x89PNG\r\n\x1a\n" +
        chunk("IHDR" + number(side) + number(side) + std::string("\1\0\0\0\0", 5)) +
        chunk("IDAT" + packed) + chunk("IEND");
    return {file.begin(), file.end()};
}

// Twelve bytes of memory for each bit, of which a byte of the file has eight thousand.
TEST_F(ImageIo, PngThatUnpacksToMoreThanItMay) {
    test::spill(path("small.png"), blackBits(100));
    EXPECT_EQ(readImage(path("small.png")).pixels, std::vector<Rgb>(10000));
    test::spill(path("large.png"), blackBits(16384));
    EXPECT_NE(messageOf<InputError>([&] { openImage(path("large.png")); }).find("found 3072 MB"),
              std::string::npos);
}

// Sizes are known before anything is decoded: in the end the rows of two files are damaged.
TEST_F(ImageIo, SizesAreReadFromHeaders) {
    const Image image = test::randomImage(40, 11, 2);
    writeImage(path("a.exr"), test::layered(image));
    writeImage(path("a.pfm"), test::layered(image));
    writeImage(path("a.png"), test::layered(image));
    writeHdr("a.hdr", image);
    for (const char* name : {"a.exr", "a.pfm", "a.png", "a.hdr"}) {
        const ImageFile file = openImage(path(name));
        EXPECT_EQ(file.size, image.size()) << name;
        EXPECT_EQ(file.decode().size(), image.size()) << name;
    }
    for (const char* name : {"a.png", "a.hdr"}) {
        test::Bytes bytes = test::slurp(path(name));
        std::fill(bytes.end() - std::ptrdiff_t(bytes.size() / 2), bytes.end(), '\0');
        test::spill(path(name), bytes);
        const ImageFile file = openImage(path(name));
        EXPECT_EQ(file.size, image.size()) << name;
        EXPECT_THROW(file.decode(), InputError) << name;
    }
}

TEST_F(ImageIo, EndingsDecide) {
    const Image image = test::randomImage(3, 2, 2);
    writeImage(path("a.EXR"), test::layered(image));
    EXPECT_EQ(readImage(path("a.EXR")).pixels, image.pixels);
    for (const char* name : {"a.jpg", "a", "a.exr.bak"}) {
        EXPECT_THROW(readImage(path(name)), UsageError) << name;
    }
    for (const char* name : {"none.exr", "none.hdr", "none.pfm", "none.png"}) {
        EXPECT_THROW(readImage(path(name)), InputError) << name;
    }
    std::filesystem::copy(path("a.EXR"), path("b.png"));
    EXPECT_NE(messageOf<InputError>([&] { readImage(path("b.png")); }).find("PNG signature"),
              std::string::npos);
    EXPECT_THROW(writeImage(path("c.png"), LayeredImage(2, 2)), std::invalid_argument);
}

}  // namespace
}  // namespace lacuna

#include "libcore/image/exr.h"

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>

#include <bit>
#include <cstring>
#include <stdexcept>

#include "tests/image/test_files.h"

namespace lacuna {
namespace {

using test::messageOf;

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](float x, float y) {
               return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
           });
}

LayeredImage manyLayers(int width, int height) {
    LayeredImage image(width, height);
    unsigned seed = 1;
    for (const char* name :
         {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z",
          "Z", "variance.R", "weighted.s02t03.R", "unweighted.s00t12.B", "node", "part.lamp.G"}) {
        image.channel(name) = test::randomFloats(std::size_t(width) * height, seed++);
    }
    image.attributes["software"] = std::string("lacuna 0.1.0");
    image.attributes["commandLine"] = std::string("lacuna-render 'a b.glb' -o \"x.exr\"\nzwei");
    image.attributes["empty"] = std::string();
    image.attributes["renderTimeSeconds"] = 0.1;
    image.attributes["rays"] = 1.2345678901234567e15;
    image.attributes["seed"] = 1;
    image.attributes["invalidSamples"] = -2147483647;
    image.attributes["a name longer than the thirty-one bytes of old files"] = 7;
    return image;
}

class Exr : public test::FileTest {
  protected:
    /// A file by OpenEXR itself, 8 x 6 pixels somewhere in a larger frame: half 1.0, or the number
    /// of the pixel as float.
    void writeForeign(const std::string& name, Imf::PixelType type, int sampling, bool tiled,
                      const std::vector<std::string>& channels = {"R", "G", "B"}) {
        const Imath::Box2i window({4, -2}, {11, 3});
        Imf::Header header(Imath::Box2i({0, 0}, {15, 7}), window);
        if (tiled) header.setTileDescription(Imf::TileDescription(3, 5));
        std::vector<std::uint32_t> values(48, 0x3c00);
        for (std::size_t i = 0; type == Imf::FLOAT && i < values.size(); ++i) {
            values[i] = std::bit_cast<std::uint32_t>(float(i));
        }
        Imf::FrameBuffer buffer;
        for (const std::string& channel : channels) {
            header.channels().insert(channel, Imf::Channel(type, sampling, sampling));
            buffer.insert(channel,
                          Imf::Slice::Make(type, values.data(), window, 4, 32, sampling, sampling));
        }
        if (tiled) {
            Imf::TiledOutputFile file(path(name).c_str(), header);
            file.setFrameBuffer(buffer);
            file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
        } else {
            Imf::OutputFile file(path(name).c_str(), header);
            file.setFrameBuffer(buffer);
            file.writePixels(6);
        }
    }
};

TEST_F(Exr, RoundTripKeepsEveryBitOfEveryLayerAndAttribute) {
    for (const auto& [width, height] : {std::pair(37, 41), std::pair(1, 1), std::pair(1, 50)}) {
        const LayeredImage written = manyLayers(width, height);
        writeExr(path("a.exr"), written);
        const LayeredImage read = readExrLayers(path("a.exr"));
        EXPECT_EQ(read.width(), width);
        EXPECT_EQ(read.height(), height);
        ASSERT_EQ(read.channels().size(), written.channels().size());
        for (const auto& [name, values] : written.channels()) {
            ASSERT_NE(read.find(name), nullptr) << name;
            EXPECT_TRUE(sameBits(*read.find(name), values)) << name;
        }
        EXPECT_EQ(read.attributes, written.attributes);
    }
    EXPECT_EQ(listing(), std::vector<std::string>{"a.exr"});
}

/// What other programs see, asked of OpenEXR itself.
TEST_F(Exr, ScanLinesZipFloat) {
    writeExr(path("a.exr"), manyLayers(9, 20));
    const Imf::InputFile file(path("a.exr").c_str());
    const Imf::Header& header = file.header();
    EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    EXPECT_FALSE(header.hasTileDescription());
    EXPECT_EQ(header.displayWindow(), Imath::Box2i({0, 0}, {8, 19}));
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        EXPECT_EQ(c.channel().type, Imf::FLOAT) << c.name();
    }
    EXPECT_STREQ(header["software"].typeName(), "string");
    EXPECT_STREQ(header["rays"].typeName(), "double");
    EXPECT_STREQ(header["seed"].typeName(), "int");
}

constexpr ExrStyle kParts{.multiPart = true};

TEST_F(Exr, RoundTripOfPartsKeepsEveryBit) {
    const LayeredImage written = manyLayers(37, 41);
    writeExr(path("a.exr"), written, kParts);
    const LayeredImage read = readExrLayers(path("a.exr"));
    ASSERT_EQ(read.channels().size(), written.channels().size());
    for (const auto& [name, values] : written.channels()) {
        ASSERT_NE(read.find(name), nullptr) << name;
        EXPECT_TRUE(sameBits(*read.find(name), values)) << name;
    }
    EXPECT_EQ(read.attributes, written.attributes);
    const Image picture = readExr(path("a.exr")), rgb = written.rgb();
    for (std::size_t i = 0; i < rgb.pixels.size(); ++i) {
        ASSERT_EQ(std::memcmp(&picture.pixels[i], &rgb.pixels[i], sizeof(Rgb)), 0) << i;
    }
}

/// The picture is the first part. The attributes of Cryptomatte are in the part of its ids, too.
TEST_F(Exr, PartsAreLayers) {
    LayeredImage image = manyLayers(9, 20);
    image.channel("A").assign(180, 1.0f);
    for (const char* name : {"R", "G", "B", "A"}) image.channel(std::string("CryptoX00.") + name);
    image.attributes["cryptomatte/1234567/name"] = std::string("CryptoX");
    writeExr(path("a.exr"), image, kParts);
    const Imf::MultiPartInputFile file(path("a.exr").c_str());
    std::map<std::string, std::vector<std::string>> parts;
    for (int i = 0; i < file.parts(); ++i) {
        const Imf::Header& header = file.header(i);
        EXPECT_EQ(header.type(), Imf::SCANLINEIMAGE);
        EXPECT_TRUE(Imf::hasChromaticities(header));
        const bool ids = header.name() == "CryptoX00";
        EXPECT_EQ(header.find("cryptomatte/1234567/name") != header.end(), ids || i == 0);
        EXPECT_EQ(header.find("software") != header.end(), i == 0);
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
            parts[header.name()].emplace_back(c.name());
        }
    }
    EXPECT_EQ(file.header(0).name(), "rgba");
    EXPECT_EQ(parts["rgba"], (std::vector<std::string>{"A", "B", "G", "R"}));
    EXPECT_EQ(parts["albedo"], (std::vector<std::string>{"albedo.B", "albedo.G", "albedo.R"}));
    EXPECT_EQ(parts["Z"], std::vector<std::string>{"Z"});
    EXPECT_EQ(parts.size(), 10u);
}

/// Layers for which half is too coarse stay float; a value that is too large becomes the largest half.
TEST_F(Exr, HalfWhereItIsEnough) {
    LayeredImage image(2, 1);
    for (const char* name : {"R", "G", "B", "albedo.R", "light.sun.R", "Z", "position.X",
                             "variance.R", "sum.0.mean.R", "CryptoObject00.R"}) {
        image.channel(name) = {1.0f / 3.0f, -1e30f};
    }
    for (const bool parts : {false, true}) {
        writeExr(path("a.exr"), image, {.half = true, .multiPart = parts});
        const LayeredImage read = readExrLayers(path("a.exr"));
        for (const char* name : {"R", "G", "B", "albedo.R", "light.sun.R"}) {
            EXPECT_EQ(*read.find(name), (std::vector<float>{0.333251953125f, -65504.0f})) << name;
        }
        for (const char* name :
             {"Z", "position.X", "variance.R", "sum.0.mean.R", "CryptoObject00.R"}) {
            EXPECT_EQ(*read.find(name), *image.find(name)) << name;
        }
    }
}

/// Rec. 709, which OpenEXR assumes of files that say nothing.
TEST_F(Exr, SayWhichColoursTheyHave) {
    writeExr(path("a.exr"), manyLayers(2, 2));
    const Imf::InputFile file(path("a.exr").c_str());
    ASSERT_TRUE(Imf::hasChromaticities(file.header()));
    const Imf::Chromaticities c = Imf::chromaticities(file.header());
    EXPECT_EQ(c.red, Imath::V2f(0.64f, 0.33f));
    EXPECT_EQ(c.green, Imath::V2f(0.30f, 0.60f));
    EXPECT_EQ(c.blue, Imath::V2f(0.15f, 0.06f));
    EXPECT_EQ(c.white, Imath::V2f(0.3127f, 0.3290f));
}

/// As others write them: channels without their layer's name, the picture not the first part, parts of other sizes.
TEST_F(Exr, ForeignParts) {
    const auto write = [&](int secondWidth) {
        const Imath::Box2i frame({0, 0}, {3, 1});
        std::vector<Imf::Header> headers{Imf::Header(frame, {{0, 0}, {2, 1}}),
                                         Imf::Header(frame, {{0, 0}, {secondWidth - 1, 1}})};
        headers[0].setName("depth");
        headers[1].setName("beauty");
        headers[0].channels().insert("R", Imf::Channel(Imf::FLOAT));
        for (const char* c : {"R", "G", "B"}) headers[1].channels().insert(c, Imf::Channel());
        for (Imf::Header& header : headers) header.setType(Imf::SCANLINEIMAGE);
        std::vector<float> floats(6, 2.0f);
        std::vector<half> halves(24, half(1.0f));
        Imf::MultiPartOutputFile file(path("a.exr").c_str(), headers.data(), 2);
        for (int i = 0; i < 2; ++i) {
            Imf::FrameBuffer buffer;
            const bool first = i == 0;
            char* at = first ? reinterpret_cast<char*>(floats.data())
                             : reinterpret_cast<char*>(halves.data());
            const std::size_t size = first ? 4 : 2;
            for (const char* c : {"R", "G", "B"}) {
                if (first && c[0] != 'R') continue;
                buffer.insert(c, Imf::Slice(first ? Imf::FLOAT : Imf::HALF, at, size, size * 3));
            }
            Imf::OutputPart part(file, i);
            part.setFrameBuffer(buffer);
            part.writePixels(2);
        }
    };
    write(3);
    EXPECT_EQ(readExr(path("a.exr")).pixels, std::vector<Rgb>(6, Rgb(1.0f)));
    const LayeredImage read = readExrLayers(path("a.exr"));
    EXPECT_EQ(read.find("R")->front(), 2.0f);
    EXPECT_EQ(read.find("beauty.R")->front(), 1.0f);
    EXPECT_EQ(read.find("B")->front(), 1.0f);
    write(4);
    EXPECT_EQ(readExr(path("a.exr")).width, 4);
    EXPECT_NE(messageOf<InputError>([&] {
                  readExrLayers(path("a.exr"));
              }).find("parts of one size, found 3 x 2 and 4 x 2"),
              std::string::npos);
}

TEST_F(Exr, TopRowComesFirstAndColoursStayApart) {
    Image image(3, 2);
    image.at(2, 0) = {1, 2, 3};
    image.at(0, 1) = {4, 5, 6};
    writeExr(path("a.exr"), test::layered(image));
    EXPECT_EQ(readExr(path("a.exr")).pixels, image.pixels);
    EXPECT_EQ(readExrLayers(path("a.exr")).rgb().pixels, image.pixels);
}

TEST_F(Exr, ThousandLayers) {
    LayeredImage image(4, 4);
    for (int i = 0; i < 1000; ++i) image.channel(std::to_string(i)).assign(16, float(i));
    writeExr(path("a.exr"), image);
    EXPECT_EQ(readExrLayers(path("a.exr")).channels(), image.channels());
}

TEST_F(Exr, ForeignFiles) {
    writeForeign("half.exr", Imf::HALF, 1, false);
    EXPECT_EQ(readExr(path("half.exr")).width, 8);
    EXPECT_EQ(readExr(path("half.exr")).height, 6);
    EXPECT_EQ(readExr(path("half.exr")).pixels, std::vector<Rgb>(48, Rgb(1)));
    for (const bool tiled : {false, true}) {
        writeForeign("float.exr", Imf::FLOAT, 1, tiled);
        const Image image = readExr(path("float.exr"));
        ASSERT_EQ(image.pixels.size(), 48u);
        for (std::size_t i = 0; i < 48; ++i) EXPECT_EQ(image.pixels[i], Rgb(float(i)));
    }
    writeForeign("integers.exr", Imf::UINT, 1, false);
    EXPECT_NE(messageOf<InputError>([&] { readExr(path("integers.exr")); }).find("integers"),
              std::string::npos);
    writeForeign("sub.exr", Imf::FLOAT, 2, false);
    EXPECT_NE(messageOf<InputError>([&] { readExr(path("sub.exr")); }).find("subsampled"),
              std::string::npos);
    writeForeign("grey.exr", Imf::FLOAT, 1, false, {"Y", "albedo.R"});
    const std::string message = messageOf<InputError>([&] { readExr(path("grey.exr")); });
    EXPECT_NE(message.find("channel R, found the channels 'Y albedo.R'"), std::string::npos)
        << message;
}

TEST_F(Exr, RefusesWhatCannotBeWritten) {
    EXPECT_THROW(writeExr(path("a.exr"), LayeredImage(2, 2)), std::invalid_argument);
    for (const char* name : {"channels", "dataWindow", "version", "type", "chromaticities", ""}) {
        LayeredImage image = test::layered(Image(2, 2));
        image.attributes[name] = std::string("x");
        EXPECT_THROW(writeExr(path("a.exr"), image), std::invalid_argument) << name;
    }
    LayeredImage image(2, 2);
    EXPECT_THROW(image.channel(""), std::invalid_argument);
    EXPECT_THROW(image.channel(std::string(256, 'x')), std::invalid_argument);
    EXPECT_THROW(image.setRgb("", Image(3, 2)), std::invalid_argument);
    EXPECT_THROW(image.rgb("albedo"), std::invalid_argument);
    EXPECT_THROW(LayeredImage(0, 2), std::invalid_argument);
    EXPECT_THROW(LayeredImage(65537, 1), std::invalid_argument);
    EXPECT_TRUE(listing().empty());
}

TEST_F(Exr, EveryTruncationIsAnInputError) {
    for (const bool parts : {false, true}) {
        writeExr(path("a.exr"), manyLayers(9, 20), {.multiPart = parts});
        const test::Bytes whole = test::slurp(path("a.exr"));
        for (std::size_t n = 0; n < whole.size(); n += (n < 1500 ? 1 : 37)) {
            test::spill(path("b.exr"),
                        test::Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(n)));
            EXPECT_THROW(readExrLayers(path("b.exr")), InputError) << n;
        }
    }
}

/// A claim of size in the header must be refused before anything is allocated by it.
TEST_F(Exr, AbsurdClaimsInTheHeader) {
    writeExr(path("a.exr"), test::layered(test::randomImage(16, 8, 1)));
    test::Bytes whole = test::slurp(path("a.exr"));
    std::string text(whole.begin(), whole.end());
    const auto patched = [&](const std::string& after, std::size_t skip, std::int32_t value) {
        test::Bytes bytes = whole;
        std::memcpy(bytes.data() + text.find(after) + after.size() + skip, &value, 4);
        test::spill(path("b.exr"), bytes);
        return messageOf<InputError>([&] { readExr(path("b.exr")); });
    };
    const std::string window("dataWindow\0box2i\0\x10\0\0\0", 21);
    ASSERT_NE(text.find(window), std::string::npos);
    EXPECT_NE(patched(window, 8, 65536).find("found 65537 x 8"), std::string::npos);
    EXPECT_NE(patched(window, 8, 2147483647).find("found 2147483648 x 8"), std::string::npos);
    EXPECT_NE(patched(window, 0, 16).find("found 0 x 8"), std::string::npos);
    EXPECT_NE(patched(window, 0, -2147483647).find("pixels a side"), std::string::npos);
    const std::string size("channels\0chlist\0", 16);
    EXPECT_NE(patched(size, 0, 0x7fffffff).find("bytes of EXR header"), std::string::npos);
    EXPECT_NE(patched(size, 0, -1).find("bytes of EXR header"), std::string::npos);
    // OpenEXR reads on behind the channels, not behind the size that the header states.
    EXPECT_NE(patched({"B\0\2", 3}, 13, 0).find("as long as their values"), std::string::npos);
    writeExr(path("a.exr"), test::layered(Image(16, 4096)));
    whole = test::slurp(path("a.exr"));
    text.assign(whole.begin(), whole.end());
    EXPECT_NE(patched(window, 8, 65535).find("found 3072 MB"), std::string::npos);
    writeExr(path("a.exr"), manyLayers(16, 8), kParts);
    whole = test::slurp(path("a.exr"));
    text.assign(whole.begin(), whole.end());
    const std::string chunks("chunkCount\0int\0\4\0\0\0", 19);
    ASSERT_NE(text.find(chunks), std::string::npos);
    EXPECT_NE(patched(chunks, 0, 1 << 20).find("too many scan lines"), std::string::npos);
    EXPECT_NE(patched(window, 8, 65536).find("found 65537 x 8"), std::string::npos);
}

TEST_F(Exr, FlippedBytesGiveAnErrorOrAnImage) {
    writeExr(path("a.exr"), manyLayers(9, 20));
    writeExr(path("parts.exr"), manyLayers(9, 20), kParts);
    writeForeign("tiled.exr", Imf::FLOAT, 1, true);
    int errors = 0;
    std::mt19937 random(7);
    for (const char* name : {"a.exr", "parts.exr", "tiled.exr"}) {
        const test::Bytes whole = test::slurp(path(name));
        for (int i = 0; i < 600; ++i) {
            test::Bytes bytes = whole;
            // Half of the flips where the structure is: in the header.
            const std::size_t range =
                i % 2 ? bytes.size() : std::min<std::size_t>(1500, bytes.size());
            bytes[random() % range] ^= char(1u << (random() % 8));
            test::spill(path("b.exr"), bytes);
            try {
                const LayeredImage image = readExrLayers(path("b.exr"));
                EXPECT_GT(image.width() * image.height(), 0);
            } catch (const InputError& e) {
                ++errors;
                EXPECT_EQ(std::string(e.what()).rfind(path("b.exr") + ": ", 0), 0u) << e.what();
            }
        }
    }
    EXPECT_GT(errors, 300);
}

TEST_F(Exr, NoImageAtAll) {
    test::spill(path("empty.exr"), "");
    EXPECT_NE(messageOf<InputError>([&] { readExr(path("empty.exr")); }).find("empty file"),
              std::string::npos);
    std::filesystem::create_directory(path("directory.exr"));
    EXPECT_NE(messageOf<InputError>([&] { readExr(path("directory.exr")); }).find("a directory"),
              std::string::npos);
    EXPECT_NE(messageOf<InputError>([&] { readExr(path("none.exr")); }).find("No such file"),
              std::string::npos);
    test::spill(path("text.exr"), "This is no image but a line of text.");
    EXPECT_NE(messageOf<InputError>([&] { readExr(path("text.exr")); }).find("an OpenEXR file"),
              std::string::npos);
}

}  // namespace
}  // namespace lacuna

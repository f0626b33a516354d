#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "render/part.h"
#include "tests/fuzz/attempt.h"

namespace lacuna::test {

bool acceptsExr(Bytes bytes) {
    const std::string path = fileOf("a.exr", bytes);
    const bool picture = attempt([&] { readExr(path); });
    const bool layers = attempt([&] {
        LayeredImage image = readExrLayers(path);
        takePart(image, path);
    });
    return picture || layers;
}

bool acceptsHdr(Bytes bytes) {
    return attempt([&] { readImage(fileOf("a.hdr", bytes)); });
}

bool acceptsPfm(Bytes bytes) {
    return attempt([&] { readImage(fileOf("a.pfm", bytes)); });
}

bool acceptsPng(Bytes bytes) {
    const std::string path = fileOf("a.png", bytes);
    isOurPng(path);
    return attempt([&] { readImage(path); });
}

bool acceptsPart(Bytes bytes) {
    // Two lines of JSON; the picture is of one pixel with the channels of one block.
    const std::string text(bytes.begin(), bytes.end());
    const std::size_t end = std::min(text.find('\n'), text.size());
    LayeredImage image(1, 1);
    for (const char* name : {"sum.0.mean.R", "sum.0.mean.G", "sum.0.mean.B", "sum.0.spread.R",
                             "sum.0.spread.G", "sum.0.spread.B", "sum.0.layer"}) {
        image.channel(name) = {1.0f};
    }
    image.attributes["partInputs"] = std::string("scene=0");
    image.attributes["partSums"] = text.substr(0, end);
    image.attributes["partTotals"] = text.substr(std::min(end + 1, text.size()));
    image.attributes["partHash"] = partHash(image);
    return attempt([&] { takePart(image, "a part"); });
}

}  // namespace lacuna::test

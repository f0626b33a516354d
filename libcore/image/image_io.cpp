#include "libcore/image/image_io.h"

#include <cctype>
#include <filesystem>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"

namespace lacuna {

std::string endingOf(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

ImageFile openImage(const std::string& path) {
    const std::string ending = endingOf(path);
    if (ending == ".exr") return openExr(path);
    if (ending == ".hdr") return openHdr(path);
    if (ending == ".pfm") return openPfm(path);
    if (ending == ".png") return openPng(path);
    throw UsageError(path + ": expected an image .exr, .hdr, .pfm or .png, found the ending '" +
                     ending + "'; convert the image");
}

Image readImage(const std::string& path) {
    return openImage(path).decode();
}

void writeImage(const std::string& path, const LayeredImage& image, const PngStyle& png,
                const ExrStyle& exr) {
    const std::string ending = endingOf(path);
    if (ending == ".exr") {
        writeExr(path, image, exr);
    } else if (ending == ".pfm") {
        writePfm(path, image.rgb());
    } else if (ending == ".png") {
        writePng(path, image.rgb(), png, image.find("A"));
    } else {
        requireWritable(path);  // throws: only this function lists the known endings
    }
}

void requireWritable(const std::string& path) {
    const std::string ending = endingOf(path);
    if (ending != ".exr" && ending != ".pfm" && ending != ".png") {
        throw UsageError(path + ": expected an output .exr, .pfm or .png, found the ending '" +
                         ending + "'; choose one of these");
    }
    const AtomicFile probe(path);  // without a commit it leaves no trace
}

}  // namespace lacuna

#include "render/checkpoint.h"

#include <filesystem>
#include <utility>

#include "libcore/base/error.h"
#include "libcore/image/exr.h"

namespace lacuna {
namespace {

void write(const std::string& path, const Part& part) {
    LayeredImage image(part.width, part.height);
    addPart(image, part);
    writeExr(path, image, {.compression = ExrCompression::None});
}

/// The layers of a checkpoint, whose file may have any name. An error of readExrLayers would
/// mislead.
LayeredImage readLayers(const std::string& path) {
    try {
        return readExrLayers(path);
    } catch (const InputError&) {
        throw InputError(path +
                         ": expected a checkpoint, found a damaged one or another file; name "
                         "another file, or delete it");
    }
}

}  // namespace

std::optional<CacheStamp> checkpointInputs(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return std::nullopt;
    LayeredImage image = readLayers(path);
    return takePart(image, path).inputs;
}

Checkpoint::Checkpoint(std::string path, double seconds)
    : path_(std::move(path)), saving_(seconds) {}

std::optional<Part> Checkpoint::load(const CacheStamp& inputs, std::uint64_t firstBlock) const {
    std::error_code ignored;
    if (!std::filesystem::exists(path_, ignored)) return std::nullopt;
    LayeredImage image = readLayers(path_);
    Part part = takePart(image, path_);
    // Parsed from text like those of a file, where line breaks in a camera's name are replaced.
    std::string different = differencesText(CacheStamp::parse(inputs.text()), part.inputs);
    if (different.empty() && part.firstBlock != firstBlock) {
        different = "first block (there " + std::to_string(part.firstBlock) + ", here " +
                    std::to_string(firstBlock) + ")";
    }
    if (!different.empty()) {
        throw InputError(path_ + ": expected a checkpoint of this command, found another " +
                         different + "; name another file, or delete it");
    }
    return part;
}

void Checkpoint::save(Part part) {
    saving_.begin([this, part = std::move(part)] { write(path_, part); });
}

void Checkpoint::finish(Part part) {
    saving_.wait();
    write(path_, part);
}

}  // namespace lacuna

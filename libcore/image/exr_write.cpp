// Writing of OpenEXR files.
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <list>
#include <map>
#include <new>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/image/exr.h"

namespace lacuna {
namespace {

/// OpenEXR's output stream into an AtomicFile.
class AtomicStream final : public Imf::OStream {
  public:
    AtomicStream(const std::string& path, AtomicFile& file)
        : Imf::OStream(path.c_str()), file_(file) {}
    void write(const char data[], int bytes) override {
        file_.write(data, std::size_t(bytes));
        if (wentBack_) hasHole_ |= std::all_of(data, data + bytes, [](char c) { return c == 0; });
    }
    uint64_t tellp() override { return file_.tell(); }
    void seekp(uint64_t position) override {
        wentBack_ = position < file_.tell();
        file_.seek(position);
    }

    /// Whether the table of scan lines, which is written last, has a zero position, that of a
    /// missing line.
    bool hasHole() const { return hasHole_; }

  private:
    AtomicFile& file_;
    bool wentBack_ = false, hasHole_ = false;
};

void insertAttribute(Imf::Header& header, const std::string& name, const Attribute& value) {
    // Names with a meaning for OpenEXR, even where this header does not hold them.
    static constexpr std::array<std::string_view, 8> reserved{
        "type", "version", "chunkCount", "name", "view", "tiles", "preview", "maxSamplesPerPixel"};
    if (name.empty() || name.size() > 255 || name.find('\0') != std::string::npos ||
        header.find(name.c_str()) != header.end() ||
        std::find(reserved.begin(), reserved.end(), name) != reserved.end()) {
        throw std::invalid_argument("EXR attribute name '" + name + "'");
    }
    if (const auto* text = std::get_if<std::string>(&value)) {
        header.insert(name, Imf::StringAttribute(*text));
    } else if (const auto* number = std::get_if<double>(&value)) {
        header.insert(name, Imf::DoubleAttribute(*number));
    } else {
        header.insert(name, Imf::IntAttribute(std::get<int>(value)));
    }
}

constexpr std::string_view kCryptomatte = "cryptomatte/", kCryptoLayer = "Crypto";

/// The layer of a channel: "albedo" for "albedo.R". The picture's channels, including alpha, form
/// the layer "". Any other channel without a dot (Z) is a layer of its own.
std::string layerOf(const std::string& channel) {
    const std::size_t dot = channel.rfind('.');
    if (dot != std::string::npos) return channel.substr(0, dot);
    const bool picture = channel == "R" || channel == "G" || channel == "B" || channel == "A";
    return picture ? "" : channel;
}

/// Whether half is too coarse for a layer (positions, ids, the sums of a part) or cannot hold its small numbers.
bool needsFloat(const std::string& layer) {
    return layer == "Z" || layer == "position" || layer.starts_with("variance") ||
           layer.starts_with("sum.") || layer.starts_with(kCryptoLayer);
}

struct ExrPart {
    Imf::Header header;
    Imf::FrameBuffer buffer;
};

/// An image as the parts of a file: one part, or (multiPart) one for each layer, the picture first.
class ExrParts {
  public:
    /// `image` must outlive the object.
    ExrParts(const LayeredImage& image, const ExrStyle& style) : image_(image), style_(style) {
        for (const auto& [name, values] : image_.channels()) {
            const std::string layer = layerOf(name);
            const auto [at, isNew] = parts_.try_emplace(style_.multiPart ? layer : "");
            if (isNew) begin(at->second.header, layer);
            addChannel(at->second, name, values, style_.half && !needsFloat(layer));
        }
        for (const auto& [name, value] : image_.attributes) {
            insertAttribute(parts_.begin()->second.header, name, value);
        }
    }

    /// OpenEXR's destructors write the tables of scan lines and swallow exceptions. Therefore
    /// AtomicFile remembers errors, and commit() reports them.
    void write(AtomicStream& stream) const {
        if (!style_.multiPart) {
            const ExrPart& part = parts_.begin()->second;
            Imf::OutputFile output(stream, part.header, 0);
            output.setFrameBuffer(part.buffer);
            output.writePixels(image_.height());
            return;
        }
        std::vector<Imf::Header> headers;
        for (const auto& [layer, part] : parts_) headers.push_back(part.header);
        Imf::MultiPartOutputFile file(stream, headers.data(), int(headers.size()), false, 0);
        int number = 0;
        for (const auto& [layer, part] : parts_) {
            Imf::OutputPart output(file, number++);
            output.setFrameBuffer(part.buffer);
            output.writePixels(image_.height());
        }
    }

  private:
    void begin(Imf::Header& header, const std::string& layer) const {
        header = Imf::Header(image_.width(), image_.height());
        const bool zip = style_.compression == ExrCompression::Zip;
        header.compression() = zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
        Imf::addChromaticities(header, Imf::Chromaticities());  // Rec. 709
        if (!style_.multiPart) return;
        header.setName(layer.empty() ? "rgba" : layer);
        header.setType(Imf::SCANLINEIMAGE);
        if (!layer.starts_with(kCryptoLayer)) return;
        for (const auto& [name, value] : image_.attributes) {
            if (name.starts_with(kCryptomatte)) insertAttribute(header, name, value);
        }
    }

    void addChannel(ExrPart& part, const std::string& name, const std::vector<float>& values,
                    bool asHalf) {
        const Imf::PixelType type = asHalf ? Imf::HALF : Imf::FLOAT;
        // OpenEXR's slices are not const, but writing only reads them.
        char* first = reinterpret_cast<char*>(const_cast<float*>(values.data()));
        std::size_t stride = sizeof(float);
        if (asHalf) {
            std::vector<half>& halves = halves_.emplace_back(values.size());
            std::ranges::transform(values, halves.begin(), [](float v) {
                return half(std::clamp(v, -float(HALF_MAX), float(HALF_MAX)));
            });
            first = reinterpret_cast<char*>(halves.data());
            stride = sizeof(half);
        }
        part.header.channels().insert(name, Imf::Channel(type));
        part.buffer.insert(name, Imf::Slice(type, first, stride, stride * image_.width()));
    }

    const LayeredImage& image_;
    const ExrStyle style_;
    std::map<std::string, ExrPart> parts_;
    std::list<std::vector<half>> halves_;  // converted channels
};

}  // namespace

void writeExr(const std::string& path, const LayeredImage& image, const ExrStyle& style) {
    if (image.channels().empty()) throw std::invalid_argument("EXR without channels");
    const ExrParts parts(image, style);
    AtomicFile file(path);
    AtomicStream stream(path, file);
    try {
        parts.write(stream);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        throw RunError(path + ": expected to write an image, found: " + e.what() +
                       "; choose another output");
    }
    // OpenEXR does not report that it lacked the memory to compress a block.
    if (stream.hasHole()) throw std::bad_alloc();
    file.commit();
}

}  // namespace lacuna

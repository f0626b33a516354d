#include "libcore/image/exr.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <set>
#include <stdexcept>
#include <string_view>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/text_list.h"
#include "libcore/image/exr_header.h"
#include "libcore/image/file_bytes.h"

namespace lacuna {
namespace {

/// OpenEXR's way into an AtomicFile.
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

    /// Whether the table of scan lines, which is written last, says of some that they are nowhere.
    bool hasHole() const { return hasHole_; }

  private:
    AtomicFile& file_;
    bool wentBack_ = false, hasHole_ = false;
};

/// OpenEXR's way out of bytes in memory.
class ByteStream final : public Imf::IStream {
  public:
    ByteStream(const std::string& path, const std::vector<std::uint8_t>& bytes)
        : Imf::IStream(path.c_str()), bytes_(bytes) {}
    bool read(char out[], int n) override {
        if (n < 0 || position_ > bytes_.size() || std::size_t(n) > bytes_.size() - position_) {
            throw std::runtime_error("the file ends too early");
        }
        std::memcpy(out, bytes_.data() + position_, std::size_t(n));
        position_ += std::size_t(n);
        return position_ < bytes_.size();
    }
    uint64_t tellg() override { return position_; }
    void seekg(uint64_t position) override { position_ = position; }

  private:
    const std::vector<std::uint8_t>& bytes_;
    std::size_t position_ = 0;
};

/// An open file whose claims have been checked; `names` are the channels that will be read.
class ExrReader {
  public:
    explicit ExrReader(const std::string& path) : path_(path), bytes_(readFileBytes(path)) {
        checkExrHeader(path, bytes_);
        stream_ = std::make_unique<ByteStream>(path, bytes_);
        file_ = std::make_unique<Imf::InputFile>(*stream_, 0);
        if (!file_->isComplete()) {
            throw InputError(path +
                             ": expected all scan lines, found a file that was not "
                             "finished; write it again");
        }
    }

    const Imf::Header& header() const { return file_->header(); }
    const Imath::Box2i& window() const { return header().dataWindow(); }
    int width() const { return window().max.x - window().min.x + 1; }
    int height() const { return window().max.y - window().min.y + 1; }

    std::vector<std::string> channelNames() const {
        std::vector<std::string> names;
        const Imf::ChannelList& list = header().channels();
        for (auto c = list.begin(); c != list.end(); ++c) names.emplace_back(c.name());
        return names;
    }

    void requireFloatChannel(const std::string& name) const {
        const Imf::Channel* channel = header().channels().findChannel(name.c_str());
        if (!channel) {
            throw InputError(path_ + ": expected a channel " + name + ", found the channels '" +
                             joined(channelNames(), " ") + "'; name an image with R, G and B");
        }
        if (channel->type != Imf::HALF && channel->type != Imf::FLOAT) {
            throw InputError(path_ + ": expected half or float in channel " + name +
                             ", found integers; convert the file");
        }
        if (channel->xSampling != 1 || channel->ySampling != 1) {
            throw InputError(path_ + ": expected channel " + name +
                             " at full resolution, found it subsampled; convert the file");
        }
    }

    /// Slice of the frame buffer whose pixel (0, 0) of the window lies at `first`.
    Imf::Slice slice(float* first, std::size_t stride) const {
        return Imf::Slice::Make(Imf::FLOAT, first, window(), stride, stride * width());
    }
    void read(const Imf::FrameBuffer& buffer) {
        file_->setFrameBuffer(buffer);
        file_->readPixels(window().min.y, window().max.y);
    }

  private:
    std::string path_;
    std::vector<std::uint8_t> bytes_;
    std::unique_ptr<ByteStream> stream_;
    std::unique_ptr<Imf::InputFile> file_;
};

/// Everything that OpenEXR or the allocator throws about a file is the file's fault.
template <class Body>
auto asInputError(const std::string& path, Body body) {
    try {
        return body();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw InputError(path +
                         ": expected an image that fits into memory, found too large a "
                         "one; is the file damaged?");
    } catch (const std::exception& e) {
        throw InputError(path + ": expected an intact OpenEXR file, found: " + e.what() +
                         "; write it again");
    }
}

void insertAttribute(Imf::Header& header, const std::string& name, const Attribute& value) {
    // Names that mean something to OpenEXR even where this header does not hold them.
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

}  // namespace

void writeExr(const std::string& path, const LayeredImage& image, ExrCompression compression) {
    if (image.channels().empty()) throw std::invalid_argument("EXR without channels");
    Imf::Header header(image.width(), image.height());
    header.compression() =
        compression == ExrCompression::Zip ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
    for (const auto& [name, value] : image.attributes) insertAttribute(header, name, value);
    Imf::FrameBuffer buffer;
    const std::size_t stride = sizeof(float);
    for (const auto& [name, values] : image.channels()) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        // OpenEXR's slices are not const, but writing only reads them.
        char* first = reinterpret_cast<char*>(const_cast<float*>(values.data()));
        buffer.insert(name, Imf::Slice(Imf::FLOAT, first, stride, stride * image.width()));
    }

    AtomicFile file(path);
    AtomicStream stream(path, file);
    try {
        // The table of scan lines is written by the destructor, which swallows exceptions: that is
        // what commit() below asks the file about.
        Imf::OutputFile output(stream, header, 0);
        output.setFrameBuffer(buffer);
        output.writePixels(image.height());
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        throw RunError(path + ": expected to write an image, found: " + e.what() +
                       "; choose another output");
    }
    // OpenEXR says nothing where it found no memory to compress a block in.
    if (stream.hasHole()) throw std::bad_alloc();
    file.commit();
}

Image readExr(const std::string& path) {
    return asInputError(path, [&] {
        ExrReader reader(path);
        for (const char* name : {"R", "G", "B"}) reader.requireFloatChannel(name);
        Image image(reader.width(), reader.height());
        Imf::FrameBuffer buffer;
        buffer.insert("R", reader.slice(&image.pixels[0].r, sizeof(Rgb)));
        buffer.insert("G", reader.slice(&image.pixels[0].g, sizeof(Rgb)));
        buffer.insert("B", reader.slice(&image.pixels[0].b, sizeof(Rgb)));
        reader.read(buffer);
        return image;
    });
}

LayeredImage readExrLayers(const std::string& path) {
    return asInputError(path, [&] {
        ExrReader reader(path);
        const std::vector<std::string> names = reader.channelNames();
        LayeredImage image(reader.width(), reader.height());
        Imf::FrameBuffer buffer;
        for (const std::string& name : names) {
            reader.requireFloatChannel(name);
            buffer.insert(name, reader.slice(image.channel(name).data(), sizeof(float)));
        }
        reader.read(buffer);
        for (auto a = reader.header().begin(); a != reader.header().end(); ++a) {
            const Imf::Attribute& value = a.attribute();
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&value)) {
                image.attributes[a.name()] = text->value();
            } else if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(&value)) {
                image.attributes[a.name()] = number->value();
            } else if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(&value)) {
                image.attributes[a.name()] = integer->value();
            }
        }
        return image;
    });
}

}  // namespace lacuna

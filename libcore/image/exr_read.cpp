// Reading of OpenEXR files.
#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>

#include "libcore/base/error.h"
#include "libcore/base/printable.h"
#include "libcore/base/text_list.h"
#include "libcore/image/exr.h"
#include "libcore/image/exr_header.h"
#include "libcore/image/file_bytes.h"

namespace lacuna {
namespace {

/// OpenEXR's input stream over bytes in memory.
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

/// An open file whose header has been checked.
class ExrReader {
  public:
    explicit ExrReader(const std::string& path) : path_(path), bytes_(readFileBytes(path)) {
        checkExrHeader(path, bytes_);
        stream_ = std::make_unique<ByteStream>(path, bytes_);
        file_ = std::make_unique<Imf::MultiPartInputFile>(*stream_, 0);
        for (int part = 0; part < parts(); ++part) {
            if (file_->partComplete(part)) continue;
            throw InputError(path +
                             ": expected all scan lines, found a file that was not "
                             "finished; write it again");
        }
        requireModestChannels();
    }

    int parts() const { return file_->parts(); }
    const Imf::Header& header(int part) const { return file_->header(part); }
    const Imath::Box2i& window(int part) const { return header(part).dataWindow(); }
    int width(int part) const { return window(part).max.x - window(part).min.x + 1; }
    int height(int part) const { return window(part).max.y - window(part).min.y + 1; }

    std::vector<std::string> channelNames(int part) const {
        std::vector<std::string> names;
        const Imf::ChannelList& list = header(part).channels();
        for (auto c = list.begin(); c != list.end(); ++c) names.emplace_back(c.name());
        return names;
    }

    void requireFloatChannel(int part, const std::string& name) const {
        const Imf::Channel* channel = header(part).channels().findChannel(name.c_str());
        if (!channel) {
            throw InputError(path_ + ": expected a channel " + name + ", found the channels '" +
                             printable(joined(channelNames(part), " ")) +
                             "'; name an image with R, G and B");
        }
        if (channel->type != Imf::HALF && channel->type != Imf::FLOAT) {
            throw InputError(path_ + ": expected half or float in channel " + printable(name) +
                             ", found integers; convert the file");
        }
        if (channel->xSampling != 1 || channel->ySampling != 1) {
            throw InputError(path_ + ": expected channel " + printable(name) +
                             " at full resolution, found it subsampled; convert the file");
        }
    }
    void requireOneSize() const {
        for (int part = 1; part < parts(); ++part) {
            if (window(part) == window(0)) continue;
            throw InputError(path_ + ": expected parts of one size, found " + sizeText(0) +
                             " and " + sizeText(part) + " pixels; convert the file");
        }
    }

    /// Slice of the frame buffer; the value of the data window's first pixel goes to `first`.
    Imf::Slice slice(int part, float* first, std::size_t stride) const {
        return Imf::Slice::Make(Imf::FLOAT, first, window(part), stride, stride * width(part));
    }
    void read(int part, const Imf::FrameBuffer& buffer) {
        Imf::InputPart input(*file_, part);
        input.setFrameBuffer(buffer);
        input.readPixels(window(part).min.y, window(part).max.y);
    }

  private:
    void requireModestChannels() const {
        std::uint64_t size = 0;
        for (int part = 0; part < parts(); ++part) {
            size += std::uint64_t(width(part)) * std::uint64_t(height(part)) * sizeof(float) *
                    channelNames(part).size();
        }
        requireModestSize(path_, size, bytes_.size());
    }
    std::string sizeText(int part) const {
        return std::to_string(width(part)) + " x " + std::to_string(height(part));
    }

    std::string path_;
    std::vector<std::uint8_t> bytes_;
    std::unique_ptr<ByteStream> stream_;
    std::unique_ptr<Imf::MultiPartInputFile> file_;
};

/// Turns every exception of OpenEXR or the allocator into an InputError: the file causes it.
template <class Body>
auto asInputError(const std::string& path, Body body) {
    try {
        return body();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw InputError(path +
                         ": expected an image that fits into memory, found too large or too "
                         "damaged a one; write it again, or raise the limit of memory (ulimit)");
    } catch (const std::exception& e) {
        throw InputError(path + ": expected an intact OpenEXR file, found: " +
                         printable(e.what(), 200) + "; write it again");
    }
}

/// The first part with a picture; if there is none, the first part.
int partOfPicture(const ExrReader& reader) {
    for (int part = 0; part < reader.parts(); ++part) {
        const Imf::ChannelList& list = reader.header(part).channels();
        if (list.findChannel("R") && list.findChannel("G") && list.findChannel("B")) return part;
    }
    return 0;
}

Image readRgb(ExrReader& reader, int part) {
    Image image(reader.width(part), reader.height(part));
    Imf::FrameBuffer buffer;
    buffer.insert("R", reader.slice(part, &image.pixels[0].r, sizeof(Rgb)));
    buffer.insert("G", reader.slice(part, &image.pixels[0].g, sizeof(Rgb)));
    buffer.insert("B", reader.slice(part, &image.pixels[0].b, sizeof(Rgb)));
    reader.read(part, buffer);
    return image;
}

void readAttributes(const Imf::Header& header, LayeredImage& image) {
    for (auto a = header.begin(); a != header.end(); ++a) {
        const std::string name = a.name();
        if (name == "name" || name == "type" || name == "chunkCount") continue;  // of the part
        const Imf::Attribute& value = a.attribute();
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&value)) {
            image.attributes[name] = text->value();
        } else if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(&value)) {
            image.attributes[name] = number->value();
        } else if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(&value)) {
            image.attributes[name] = integer->value();
        }
    }
}

}  // namespace

ImageFile openExr(const std::string& path) {
    return asInputError(path, [&] {
        const auto reader = std::make_shared<ExrReader>(path);
        const int part = partOfPicture(*reader);
        for (const char* name : {"R", "G", "B"}) reader->requireFloatChannel(part, name);
        const ImageSize size{reader->width(part), reader->height(part)};
        return ImageFile{
            size, [=] { return asInputError(path, [&] { return readRgb(*reader, part); }); }};
    });
}

Image readExr(const std::string& path) {
    return openExr(path).decode();
}

LayeredImage readExrLayers(const std::string& path) {
    return asInputError(path, [&] {
        ExrReader reader(path);
        reader.requireOneSize();
        LayeredImage image(reader.width(0), reader.height(0));
        for (int part = 0; part < reader.parts(); ++part) {
            Imf::FrameBuffer buffer;
            for (const std::string& name : reader.channelNames(part)) {
                reader.requireFloatChannel(part, name);
                const Imf::Header& header = reader.header(part);
                const bool taken = image.find(name) && header.hasName();
                std::vector<float>& values =
                    image.channel(taken ? header.name() + "." + name : name);
                buffer.insert(name, reader.slice(part, values.data(), sizeof(float)));
            }
            reader.read(part, buffer);
        }
        readAttributes(reader.header(0), image);
        return image;
    });
}

}  // namespace lacuna

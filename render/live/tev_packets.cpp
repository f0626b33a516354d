#include "render/live/tev_packets.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

namespace lacuna {
namespace {

static_assert(std::endian::native == std::endian::little, "values are sent as they are in memory");

constexpr std::uint8_t kCreateImage = 4;
constexpr std::uint8_t kUpdateImage = 6;
constexpr int kTileValues = 1 << 16;  // 256 kB; a newer picture may begin between two tiles

class Writer {
  public:
    explicit Writer(std::uint8_t kind) {
        add(std::uint32_t(0));  // placeholder for the length
        add(kind);
    }

    template <class T>
    void add(T value) {
        append(&value, sizeof value);
    }
    void add(bool on) { add(std::uint8_t(on)); }
    void add(const std::string& text) { append(text.c_str(), text.size() + 1); }
    void append(const void* data, std::size_t bytes) {
        const auto* from = static_cast<const std::byte*>(data);
        packet_.insert(packet_.end(), from, from + bytes);
    }
    void reserve(std::size_t bytes) { packet_.reserve(packet_.size() + bytes); }

    Packet take() {
        const auto length = std::uint32_t(packet_.size());
        std::memcpy(packet_.data(), &length, sizeof length);
        return std::move(packet_);
    }

  private:
    Packet packet_;
};

}  // namespace

Packet createImage(const TevImage& image) {
    Writer writer(kCreateImage);
    writer.add(true);
    writer.add(image.name);
    writer.add(std::int32_t(image.width));
    writer.add(std::int32_t(image.height));
    writer.add(std::int32_t(image.channels.size()));
    for (const std::string& channel : image.channels) writer.add(channel);
    return writer.take();
}

Packet updateImage(const TevImage& image, const PixelRect& tile,
                   std::span<const std::vector<float>* const> planes) {
    const auto pixels = std::int64_t(tile.width()) * tile.height();
    Writer writer(kUpdateImage);
    writer.add(false);
    writer.add(image.name);
    writer.add(std::int32_t(planes.size()));
    for (const std::string& channel : image.channels) writer.add(channel);
    for (const int value : {tile.x0, tile.y0, tile.width(), tile.height()}) {
        writer.add(std::int32_t(value));
    }
    for (std::size_t c = 0; c < planes.size(); ++c) writer.add(std::int64_t(c) * pixels);
    for (std::size_t c = 0; c < planes.size(); ++c) writer.add(std::int64_t(1));
    writer.reserve(planes.size() * std::size_t(pixels) * sizeof(float));
    for (const std::vector<float>* plane : planes) {
        for (int y = tile.y0; y < tile.y1; ++y) {
            const std::size_t first = std::size_t(y) * std::size_t(image.width) + tile.x0;
            writer.append(plane->data() + first, std::size_t(tile.width()) * sizeof(float));
        }
    }
    return writer.take();
}

std::vector<PixelRect> tilesOf(const TevImage& image) {
    const int pixels = std::max(1, kTileValues / int(image.channels.size()));
    const int width = std::min(image.width, pixels);
    const int height = std::max(1, pixels / width);
    std::vector<PixelRect> tiles;
    for (int y = 0; y < image.height; y += height) {
        for (int x = 0; x < image.width; x += width) {
            tiles.push_back(
                {x, std::min(x + width, image.width), y, std::min(y + height, image.height)});
        }
    }
    return tiles;
}

}  // namespace lacuna

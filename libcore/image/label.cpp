#include "libcore/image/label.h"

#include <algorithm>

// The font consists of rectangles on a raster. Its unit is two pixels here.
#include <stb/stb_easy_font.h>

namespace lacuna {
namespace {

constexpr int kScale = 2;
constexpr int kLine = 11;  // height of a line in units, with room for g and y

/// The text with one byte for each character.
std::string ascii(const std::string& text) {
    std::string plain;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xc0) == 0x80) continue;  // a continuation byte of UTF-8
        plain.push_back(byte >= 32 && byte < 127 ? c : '?');
    }
    return plain;
}

struct Corner {
    float x, y, z;
    std::uint8_t colour[4];
};

}  // namespace

Canvas::Canvas(int width, int height, const Colour8& ground)
    : width_(width), height_(height), bytes_(std::size_t(width) * std::size_t(height) * 3) {
    fill(0, 0, width, height, ground);
}

void Canvas::fill(int x, int y, int width, int height, const Colour8& colour) {
    const int x1 = std::min(x + width, width_), y1 = std::min(y + height, height_);
    for (int row = std::max(y, 0); row < y1; ++row) {
        for (int column = std::max(x, 0); column < x1; ++column) {
            const std::size_t at =
                (std::size_t(row) * std::size_t(width_) + std::size_t(column)) * 3;
            std::copy(colour.begin(), colour.end(), bytes_.begin() + std::ptrdiff_t(at));
        }
    }
}

void Canvas::write(int x, int y, const std::string& text, const Colour8& colour) {
    std::string plain = ascii(text);
    constexpr std::size_t kCornersPerCharacter = 4 * 32;
    std::vector<Corner> corners((plain.size() + 1) * kCornersPerCharacter);
    const int quads = stb_easy_font_print(0.0f, 0.0f, plain.data(), nullptr, corners.data(),
                                          int(corners.size() * sizeof(Corner)));
    for (int i = 0; i < quads; ++i) {
        const Corner& first = corners[std::size_t(4 * i)];
        const Corner& last = corners[std::size_t(4 * i + 2)];  // diagonally opposite to the first
        fill(x + kScale * int(first.x), y + kScale * int(first.y), kScale * int(last.x - first.x),
             kScale * int(last.y - first.y), colour);
    }
}

int Canvas::widthOf(const std::string& text) {
    std::string plain = ascii(text);
    return kScale * stb_easy_font_width(plain.data());
}

int Canvas::lineHeight() {
    return kScale * kLine;
}

std::string fitted(const std::string& text, int width) {
    if (Canvas::widthOf(text) <= width) return text;
    std::string part = ascii(text);
    while (!part.empty() && Canvas::widthOf(part + "..") > width) part.pop_back();
    return part + "..";
}

}  // namespace lacuna

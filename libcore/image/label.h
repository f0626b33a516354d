// Pictures with text on them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

using Colour8 = std::array<std::uint8_t, 3>;

/// A picture of sRGB bytes, top row first, for drawing. Everything is clipped to it.
class Canvas {
  public:
    Canvas(int width, int height, const Colour8& ground);

    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<std::uint8_t>& bytes() const { return bytes_; }

    void fill(int x, int y, int width, int height, const Colour8& colour);
    /// Writes one line with its upper left corner at (x, y). Characters outside ASCII become '?'.
    void write(int x, int y, const std::string& text, const Colour8& colour);

    /// Size of what `write` draws, in pixels.
    static int widthOf(const std::string& text);
    static int lineHeight();

  private:
    int width_, height_;
    std::vector<std::uint8_t> bytes_;
};

/// The text cut to `width` pixels; it ends with dots if it was cut.
std::string fitted(const std::string& text, int width);

}  // namespace lacuna

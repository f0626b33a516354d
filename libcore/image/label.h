// Pictures with writing on them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna {

using Colour8 = std::array<std::uint8_t, 3>;

/// sRGB bytes, top row first, that are drawn on. What lies outside is left out.
class Canvas {
  public:
    Canvas(int width, int height, const Colour8& ground);

    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<std::uint8_t>& bytes() const { return bytes_; }

    void fill(int x, int y, int width, int height, const Colour8& colour);
    /// One line, its upper left at (x, y); what is not ASCII is shown as '?'.
    void write(int x, int y, const std::string& text, const Colour8& colour);

    /// Of what `write` draws, in pixels.
    static int widthOf(const std::string& text);
    static int lineHeight();

  private:
    int width_, height_;
    std::vector<std::uint8_t> bytes_;
};

/// As much of the text as `width` pixels hold; dots at the end where that is not all.
std::string fitted(const std::string& text, int width);

}  // namespace lacuna

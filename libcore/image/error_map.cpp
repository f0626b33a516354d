#include "libcore/image/error_map.h"

#include <algorithm>
#include <cmath>

namespace lacuna {
namespace {

// One anchor per half decade from kErrorMapLow to kErrorMapHigh. CIE lightness rises by 10 to 14
// from each to the next, so that the order is visible without a legend (and in a grey print).
constexpr double kAnchors[][3] = {{0, 0, 0},      {40, 12, 90},   {95, 15, 120},
                                  {160, 30, 110}, {210, 55, 80},  {235, 100, 45},
                                  {245, 150, 30}, {250, 205, 75}, {255, 250, 190}};
constexpr int kIntervals = int(std::size(kAnchors)) - 1;

}  // namespace

std::array<std::uint8_t, 3> errorColour(double relativeError) {
    const double clamped = std::clamp(relativeError, kErrorMapLow, kErrorMapHigh);
    const double position =
        kIntervals * std::log10(clamped / kErrorMapLow) / std::log10(kErrorMapHigh / kErrorMapLow);
    const int i = std::clamp(int(position), 0, kIntervals - 1);
    std::array<std::uint8_t, 3> out{};
    for (int c = 0; c < 3; ++c) {
        out[c] = std::uint8_t(std::lround(
            std::lerp(kAnchors[i][c], kAnchors[i + 1][c], std::clamp(position - i, 0.0, 1.0))));
    }
    return out;
}

std::vector<std::uint8_t> errorMap(const Image& image, const ErrorReference& reference,
                                   const std::string& name) {
    reference.requireComparable(image, name);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.pixels.size() * 3);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto colour = errorColour(reference.relativeError(image, x, y));
            bytes.insert(bytes.end(), colour.begin(), colour.end());
        }
    }
    return bytes;
}

}  // namespace lacuna

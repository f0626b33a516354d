// A rendered picture with its layers and statistics.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

class LayeredImage;

/// Errors of an image I against a reference R: means over all pixels and the three channels. e is a
/// hundredth of the reference's mean.
struct Errors {
    double mae = 0.0;     ///< mean |I - R|
    double rmse = 0.0;    ///< root of the mean (I - R)^2
    double mape = 0.0;    ///< mean |I - R| / (R + e)
    double relmse = 0.0;  ///< mean (I - R)^2 / (R^2 + e^2)
};

/// A picture is immutable. Copies share the pixels.
class Picture {
  public:
    /// Reads an .exr with its layers, an .hdr, .pfm or .png. Throws InputError.
    static Picture load(const std::string& path);
    /// A picture of given pixels, in the layout of rgb(). Throws UsageError for another number of
    /// values.
    Picture(int width, int height, std::span<const float> rgb);
    /// For internal use. `statistics`: a JSON object as text.
    Picture(LayeredImage image, std::string statistics);

    int width() const;
    int height() const;
    /// Linear Rec. 709 radiance: height rows, top row first, of width pixels of R, G, B.
    std::span<const float> rgb() const;

    /// Names of the channels, as in an .exr: "R", "G", "B", "Z", "albedo.R", "normal.X",
    /// "variance.G", .. (libcore/doc/files.md).
    std::vector<std::string> channels() const;
    /// The channel's height x width values, top row first. Throws UsageError for an unknown name.
    std::span<const float> channel(const std::string& name) const;

    /// The statistics that `lacuna-render --json` writes, a JSON object as text. For a picture that was read or relit,
    /// its header.
    const std::string& statistics() const;

    /// The picture under changed light: the light of each named group is multiplied by its factors for R, G, B. Other
    /// groups stay as they are. The render must have had the option light-groups. Layers that depend on the old light
    /// are left out. So is "variance", unless the render had the option light-noise or all factors are equal. Throws
    /// UsageError for an unknown group or a factor below 0, InputError for a picture without groups.
    Picture relight(const std::map<std::string, std::array<double, 3>>& factors) const;

    /// Writes an .exr with all layers, a .pfm, or a .png with automatic exposure. The file is
    /// written whole or not at all. Throws UsageError for another ending, RunError if it cannot be
    /// written.
    void save(const std::string& path) const;

    /// The errors of this picture against `reference`. Throws InputError if sizes differ or a pixel
    /// is not finite.
    Errors compare(const Picture& reference) const;

  private:
    struct Content;
    std::shared_ptr<const Content> content_;
};

}  // namespace lacuna

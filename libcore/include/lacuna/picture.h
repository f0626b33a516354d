// A rendered picture, with its layers and with everything that was measured.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

class LayeredImage;

/// How far an image is from a reference, over all pixels and the three channels. e is a hundredth
/// of the reference's mean.
struct Errors {
    double mae = 0.0;     ///< mean |I - R|
    double rmse = 0.0;    ///< root of the mean (I - R)^2
    double mape = 0.0;    ///< mean |I - R| / (R + e)
    double relmse = 0.0;  ///< mean (I - R)^2 / (R^2 + e^2)
};

/// Copies share the pixels, which nobody can change.
class Picture {
  public:
    /// Reads an .exr with its layers, an .hdr, .pfm or .png. Throws InputError.
    static Picture load(const std::string& path);
    /// Of pixels from elsewhere, as rgb() has them. Throws UsageError for another number of values.
    Picture(int width, int height, std::span<const float> rgb);
    /// For the library. `statistics`: a JSON object as text.
    Picture(LayeredImage image, std::string statistics);

    int width() const;
    int height() const;
    /// Linear Rec. 709 radiance: height rows, the top one first, of width pixels of R, G, B.
    std::span<const float> rgb() const;

    /// "R", "G", "B", "Z", "albedo.R", "normal.X", "variance.G", ..: as an .exr has them
    /// (libcore/doc/files.md).
    std::vector<std::string> channels() const;
    /// height x width values, the top row first. Throws UsageError for a name that is not there.
    std::span<const float> channel(const std::string& name) const;

    /// What `lacuna-render --json` writes: a JSON object as text. Of a picture that was read or relit,
    /// its header.
    const std::string& statistics() const;

    /// Under other light, of a render with the option light-groups: the light of each group multiplied
    /// by R, G, B. Groups that are not named stay as they are. Layers that are of the old light
    /// are left out, and so is "variance", unless the render had the option light-noise or all
    /// factors are the same. Throws UsageError for a group that is not there or a factor below 0,
    /// InputError for a picture without groups.
    Picture relight(const std::map<std::string, std::array<double, 3>>& factors) const;

    /// .exr with all layers, .pfm, or .png, which is exposed by itself. Written whole or not at
    /// all. Throws UsageError for another ending, RunError.
    void save(const std::string& path) const;

    /// Throws InputError where sizes differ or a pixel is not finite.
    Errors compare(const Picture& reference) const;

  private:
    struct Content;
    std::shared_ptr<const Content> content_;
};

}  // namespace lacuna

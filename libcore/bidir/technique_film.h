// Layers of what each technique (s, t) adds to the picture, and of its variance.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/bidir/technique_group.h"

namespace lacuna {

/// A contribution of one technique to a pixel.
struct TechniqueSample {
    int s, t;  ///< merges: at x_s, the last of t vertices from the eye
    TechniqueGroup group;
    std::uint32_t pixel;
    Rgb weighted, unweighted;
};

/// Sums over a block's iterations: --techniques.
///
/// Every technique that contributed has the layers weighted.sSStTT and unweighted.sSStTT. Merges at
/// x_i, the last of t vertices from the eye, have mIItTT in place of sSStTT. A group of techniques
/// has weighted.GROUP, the mean of the channels. Techniques and groups also have square.NAME: the
/// channels' mean, squared, in the mean over independent samples. Variances are made of it.
class TechniqueFilm final : public BlockLayers {
  public:
    /// `sampleIterations` is BlockPlan::sampleIterations(). `merges` says whether there are merges.
    TechniqueFilm(int width, int height, int maxDepth, std::uint64_t sampleIterations = 1,
                  bool merges = false);

    /// "s02t03", "m02t03"
    static std::string layerName(int s, int t, bool merged = false);
    /// Names of all channels that a film of this depth may have in an image
    /// (setTechniqueVariances).
    static std::vector<std::string> channelNames(int maxDepth);
    /// Different pixels may be added to at the same time.
    void add(const TechniqueSample& sample);
    void countIteration();
    Layers means() const override;
    void clear() override;
    /// Means per pixel of a technique's contributions, with and without their weights. For merges `s` is i.
    Image weighted(int s, int t, bool merged = false) const {
        return mean(of(s, t, merged).weighted);
    }
    Image unweighted(int s, int t, bool merged = false) const {
        return mean(of(s, t, merged).unweighted);
    }

  private:
    /// Moments of a value per pixel. `now` is its sum over the current sample. Over the samples before, `sum` adds
    /// these sums up, and `squares` their squares over the sample's iterations.
    struct Moments {
        std::vector<float> now, sum, squares;
        explicit Moments(std::size_t pixels) : now(pixels), sum(pixels), squares(pixels) {}
        bool isZero() const;
    };
    struct Technique {
        std::vector<Rgb> weighted, unweighted;
        Moments moments;
        explicit Technique(std::size_t pixels)
            : weighted(pixels), unweighted(pixels), moments(pixels) {}
    };

    std::size_t indexOf(int s, int t) const;
    const Technique& of(int s, int t, bool merged) const {
        return (merged ? merges_ : techniques_)[indexOf(s, t)];
    }
    Image mean(const std::vector<Rgb>& sum) const;
    std::vector<float> meanOf(const Moments& moments) const;
    std::vector<float> meanSquareOf(const Moments& moments) const;
    template <class Visit>
    void forEachMoments(const Visit& visit);

    int width_, height_, maxDepth_;
    std::uint64_t sampleIterations_;
    std::uint64_t iterations_ = 0, inSample_ = 0;
    std::vector<Technique> techniques_;
    std::vector<Technique> merges_;  // empty where the row has none
    std::vector<Moments> groups_;
};

/// Variance per pixel of the mean of `samples` samples, for the technique or group `name` of a
/// film's layers. It is that of the channels' mean. Empty where the layers do not have it.
std::vector<float> techniqueVariance(const Layers& layers, const std::string& name,
                                     std::uint64_t samples);

/// Replaces the layers square.NAME by variance.NAME.
void setTechniqueVariances(LayeredImage& image, const Layers& layers, std::uint64_t samples);

/// The channel share.t02 from the layers weighted.sSStTT of paths of up to `maxDepth` edges: what
/// connections of the first eye vertex (t = 2, s > 0) add to the pixel's mean over the channels, as
/// a share of it [Nabata20a fig 2]; 0 where it is black.
void addShareOfFirstConnections(LayeredImage& image, int maxDepth);

}  // namespace lacuna

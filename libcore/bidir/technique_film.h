// What each technique (s, t) adds to the picture, and how noisy that is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/bidir/technique_group.h"

namespace lacuna {

/// What a technique adds to a pixel.
struct TechniqueSample {
    int s, t;  ///< merges: at x_s, the last of t vertices from the eye
    TechniqueGroup group;
    std::uint32_t pixel;
    Rgb weighted, unweighted;
};

/// Summed over a block's iterations: --techniques.
///
/// Layers, of techniques that contributed: weighted.sSStTT and unweighted.sSStTT, of merges at x_i
/// with the last of t vertices from the eye weighted.mIItTT likewise; weighted.GROUP by
/// group of techniques, the mean of the channels; and for both square.NAME, the mean square of the
/// mean of the channels over independent samples, which variances are made of.
class TechniqueFilm final : public BlockLayers {
  public:
    /// `sampleIterations`: BlockPlan's. `merges`: with layers for them.
    TechniqueFilm(int width, int height, int maxDepth, std::uint64_t sampleIterations = 1,
                  bool merges = false);

    /// "s02t03", "m02t03"
    static std::string layerName(int s, int t, bool merged = false);
    /// Of all channels that a film of this depth may come to have in an image (setVariances).
    static std::vector<std::string> channelNames(int maxDepth);
    /// Different pixels may be added to at the same time.
    void add(const TechniqueSample& sample);
    void countIteration();
    Layers means() const override;
    void clear() override;
    Image weighted(int s, int t, bool merged = false) const {
        return mean(of(s, t, merged).weighted);
    }
    Image unweighted(int s, int t, bool merged = false) const {
        return mean(of(s, t, merged).unweighted);
    }

  private:
    /// Of a value per pixel: its sum over the sample under way, and over those before sums of it and
    /// of its square per iteration of the sample.
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
    std::vector<Technique> merges_;  // none where the row has none
    std::vector<Moments> groups_;
};

/// Variance of the mean of `samples` samples, of the technique or group NAME of a film's layers:
/// of the mean of the channels. Empty where it has none.
std::vector<float> techniqueVariance(const Layers& layers, const std::string& name,
                                     std::uint64_t samples);

/// Replaces the layers square.NAME by variance.NAME.
void setTechniqueVariances(LayeredImage& image, const Layers& layers, std::uint64_t samples);

/// The channel share.t02 from the layers weighted.sSStTT of paths of up to `maxDepth` edges: what
/// connections of the first eye vertex (t = 2, s > 0) add to the pixel's mean over the channels, as
/// a share of it [Nabata20a fig 2]; 0 where it is black.
void addShareOfFirstConnections(LayeredImage& image, int maxDepth);

}  // namespace lacuna

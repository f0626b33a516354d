// Sums of iterations: means and spreads. The order of summation does not depend on who made which
// iteration when. So a picture made in pieces equals the picture made in one go, to the last bit.
// (theory.md, "Blocks")
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/image/image.h"

namespace lacuna {

class ErrorMeter;
class ThreadPool;

/// Channels beside the picture, by name.
using Layers = std::map<std::string, std::vector<float>>;

/// Differences h between the two halves of nodes of one size, summed over the nodes
/// (error_estimate.h).
struct HalfDifference {
    std::uint64_t iterations = 0;  ///< of a node
    std::uint64_t nodes = 0;
    double sum = 0.0;         ///< of h, the mean of |A - B| / 2 (R + e)
    double squares = 0.0;     ///< of h^2
    double unevenness = 0.0;  ///< of h (ErrorMeter::Mean)

    double mean() const { return sum / double(nodes); }
    friend bool operator==(const HalfDifference&, const HalfDifference&) = default;
};

/// The mean of a number of iterations, and how far they lie from it.
struct FilmSum {
    std::uint64_t iterations = 0;
    /// Independent samples of the picture among them (BlockPlan::sampleIterations).
    std::uint64_t samples = 0;
    std::vector<Rgb> mean;  ///< by pixel
    /// By pixel and channel: the root of S, the sum over the samples of (a sample's iterations) x
    /// (its distance from the mean)^2. For a single sample the sum runs over its iterations, as if
    /// they were independent. Empty means zero everywhere.
    std::vector<Rgb> spread;
    /// The mean, and S (not its root), of the picture's mean colour.
    std::array<double, 3> wholeMean{}, wholeSquares{};
    Layers layers;                            ///< further means; a channel that is missing is zero
    std::vector<HalfDifference> differences;  ///< smaller nodes first

    /// An iteration's picture, row by row.
    static FilmSum ofIteration(std::span<const Rgb> pixels, int width, const ThreadPool& threads);

    Image image(int width, int height) const;
    /// The squared spread over this divisor is the variance of the mean. The divisor is the iterations times the
    /// degrees of freedom: those of the samples or, where the only sample has a spread, those of its iterations. Zero
    /// where no variance is known.
    double varianceDivisor() const;
    /// Variance of the mean per pixel and channel; zero where none is known.
    Image variance(int width, int height) const;
    struct MeanColour {
        double mean[3] = {0, 0, 0};
        double standardError[3] = {0, 0, 0};  ///< zero where none is known
    };
    /// The mean colour of the whole picture, and its standard error from the spread of the samples.
    MeanColour meanColour() const;
};

/// Whether sums hold their layers or the picture alone, which is quicker.
enum class Layered { Yes, No };

/// How two sums relate to each other.
enum class SumRelation {
    Samples,       ///< independent of each other
    OfEvenSample,  ///< parts of one sample, farther apart than independent samples
    OfAlikeSample  ///< parts of one sample, alike: their distance is no measure of noise
};

/// Adds `right` to `left` [Chan83]. The spread inside a sample is dropped where the sample meets
/// another one. `threads` may be null.
void join(FilmSum& left, const FilmSum& right, SumRelation relation, const ThreadPool* threads,
          Layered layered = Layered::Yes);

/// Sums consecutive items. Item i is a leaf of the binary tree whose nodes are [k 2^l, (k+1) 2^l),
/// and only the largest whole nodes are kept. Two trees of neighbouring ranges join to the tree of
/// both ranges, bit for bit.
class SumTree {
  public:
    struct Node {
        std::uint64_t begin = 0, size = 0;  ///< items; size a power of two that divides begin
        std::shared_ptr<FilmSum> sum;       ///< not changed while anyone else holds it
    };

    /// `sampleItems` consecutive items, from a multiple of that number on, are one sample. `within`
    /// is what they are to each other.
    explicit SumTree(std::uint64_t sampleItems, SumRelation within = SumRelation::OfEvenSample)
        : sampleItems_(sampleItems), within_(within) {}

    /// Compares the halves of nodes from now on. Item i is `iterations` iterations; the first one has the number
    /// `first` + i * `iterations`. Halves of a sample must not be alike. Halves of an even sample overstate the
    /// noise (theory.md).
    void measure(const ErrorMeter* meter, std::uint64_t first, std::uint64_t iterations);
    /// Adds a node that follows all others. `threads` may be null.
    void add(Node node, const ThreadPool* threads);
    /// The nodes. A copy of the list keeps its sums: a sum that others hold is never changed.
    const std::vector<Node>& nodes() const { return nodes_; }
    bool empty() const { return nodes_.empty(); }
    void clear() { nodes_.clear(); }
    /// Adds all nodes to `sum`, the first one first. `threads` may be null.
    void addTo(FilmSum& sum, const ThreadPool* threads, Layered layered = Layered::Yes) const;

  private:
    void joinLast(const ThreadPool* threads);

    std::uint64_t sampleItems_;
    SumRelation within_;
    const ErrorMeter* meter_ = nullptr;
    std::uint64_t first_ = 0, itemIterations_ = 1;
    std::vector<Node> nodes_;
};

}  // namespace lacuna

// What iterations add up to: means and spreads, summed in an order that does not depend on who
// made which iteration when, so that a picture that was made in pieces is the picture made in one
// go to the last bit. (theory.md, "Blocks")
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

/// How far the two halves of nodes of one size are apart (error_estimate.h): sums over the nodes.
struct HalfDifference {
    std::uint64_t iterations = 0;  ///< of a node
    std::uint64_t nodes = 0;
    double sum = 0.0;         ///< of the mean of |A - B| / 2 (R + e)
    double squares = 0.0;     ///< of its square
    double unevenness = 0.0;  ///< of the share of it that few places carry

    double mean() const { return sum / double(nodes); }
    friend bool operator==(const HalfDifference&, const HalfDifference&) = default;
};

/// The mean of a number of iterations, and how far they lie from it.
struct FilmSum {
    std::uint64_t iterations = 0;
    /// Independent samples of the picture among them (BlockPlan::sampleIterations).
    std::uint64_t samples = 0;
    std::vector<Rgb> mean;  ///< by pixel
    /// By pixel and channel: root of the sum over the samples of (a sample's iterations) x (its
    /// distance from the mean)^2; of a single sample likewise over its iterations, as if they were
    /// independent. Empty: zero everywhere.
    std::vector<Rgb> spread;
    /// The same of the picture's mean colour; squared.
    std::array<double, 3> wholeMean{}, wholeSquares{};
    Layers layers;                            ///< further means; a channel that is missing is zero
    std::vector<HalfDifference> differences;  ///< smaller nodes first

    /// An iteration's picture, row by row.
    static FilmSum ofIteration(std::span<const Rgb> pixels, int width, const ThreadPool& threads);

    Image image(int width, int height) const;
    /// A squared spread over this is the variance of the mean: iterations times the degrees of freedom
    /// of the samples, or of what the only one is made of, if that has a spread. 0: none is known.
    double varianceDivisor() const;
    /// Variance of the mean per pixel and channel; zero where none is known.
    Image variance(int width, int height) const;
    struct MeanColour {
        double mean[3] = {0, 0, 0};
        double standardError[3] = {0, 0, 0};  ///< zero where none is known
    };
    /// Of the whole picture, its standard error from the spread of the samples' means.
    MeanColour meanColour() const;
};

/// Whether sums hold their layers or the picture alone, which is quicker.
enum class Layered { Yes, No };

/// What two sums are to each other.
enum class Parts {
    Samples,       ///< independent of each other
    OfEvenSample,  ///< parts of one, further apart than independent ones would be
    OfAlikeSample  ///< parts of one, alike: their distance says nothing of its spread
};

/// Adds `right` to `left` [Chan83]. What a sample's own iterations spread by is forgotten where it
/// meets another. `threads` may be null.
void join(FilmSum& left, const FilmSum& right, Parts parts, const ThreadPool* threads,
          Layered layered = Layered::Yes);

/// Sums of items that come one after the other: item i is a leaf of the binary tree whose nodes
/// are [k 2^l, (k+1) 2^l), and of the tree only the largest whole nodes are kept. Two trees of
/// neighbouring ranges join to that of both, bit for bit.
class SumTree {
  public:
    struct Node {
        std::uint64_t begin = 0, size = 0;  ///< items; size a power of two that divides begin
        std::shared_ptr<FilmSum> sum;       ///< not changed while anyone else holds it
    };

    /// `sampleItems`: so many items are one sample, those behind a multiple of it; `within`: what
    /// they are to each other.
    explicit SumTree(std::uint64_t sampleItems, Parts within = Parts::OfEvenSample)
        : sampleItems_(sampleItems), within_(within) {}

    /// Compares the halves of nodes from now on. Item i is `iterations` iterations from `first` + i
    /// times that many on. Halves of a sample must not be alike; unlike ones say too much (theory.md).
    void measure(const ErrorMeter* meter, std::uint64_t first, std::uint64_t iterations);
    /// A node behind all others. `threads` may be null.
    void add(Node node, const ThreadPool* threads);
    /// What a copy of this holds stays as it is.
    const std::vector<Node>& nodes() const { return nodes_; }
    bool empty() const { return nodes_.empty(); }
    void clear() { nodes_.clear(); }
    /// Adds all nodes to `sum`, the first one first. `threads` may be null.
    void addTo(FilmSum& sum, const ThreadPool* threads, Layered layered = Layered::Yes) const;

  private:
    void joinLast(const ThreadPool* threads);

    std::uint64_t sampleItems_;
    Parts within_;
    const ErrorMeter* meter_ = nullptr;
    std::uint64_t first_ = 0, itemIterations_ = 1;
    std::vector<Node> nodes_;
};

}  // namespace lacuna

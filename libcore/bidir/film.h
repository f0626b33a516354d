// Films: the picture of one iteration, and the sum of all iterations.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/film_sum.h"

namespace lacuna {

class ThreadPool;

/// Half-open rectangle of pixels.
struct PixelRect {
    int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
    friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// A contribution to a pixel that its maker does not own.
struct Splat {
    std::uint32_t pixel;  ///< row-major index in the crop
    Rgb value;
};

/// Adds the lists of splats in order: chunk by chunk, each in its own order, so that sums are the
/// same to the last bit for any number of threads. Returns how many were left out
/// because their pixel's sum would not have been finite.
std::uint64_t addSplats(std::span<const std::vector<Splat>> chunks, std::span<Rgb> pixels,
                        const ThreadPool& pool);

/// The mean over iterations, from their `sum` by pixel. Black where there are no iterations.
Image meanOfSum(std::span<const Rgb> sum, std::uint64_t iterations, int width, int height);

/// Layers that are filled while the iterations of a block run.
class BlockLayers {
  public:
    virtual ~BlockLayers() = default;
    /// Means over the block's iterations so far, of layers that are not black.
    virtual Layers means() const = 0;
    /// Begins a new block.
    virtual void clear() = 0;
};

/// How the iterations of a render are grouped. (theory.md, "Blocks")
struct BlockPlan {
    static constexpr std::uint64_t kEndless = std::uint64_t(1) << 40;

    std::uint64_t iterations = kEndless;  ///< B: of a block
    /// Whether blocks are the independent samples: then iterations of a block share light paths.
    bool areSamples = false;
    /// Otherwise the samples are groups of so many iterations. A power of two: the random numbers
    /// of a group lie evenly together.
    std::uint64_t groupIterations = 1;

    /// Iterations of an independent sample.
    std::uint64_t sampleIterations() const { return areSamples ? iterations : groupIterations; }
    /// How the iterations of a sample relate to each other.
    SumRelation relationInSample() const {
        return areSamples ? SumRelation::OfAlikeSample : SumRelation::OfEvenSample;
    }
};

/// The open block's iterations as one sum, with what its layers hold. `threads` may be null.
FilmSum sumOfBlock(const SumTree& open, std::span<BlockLayers* const> layers,
                   const ThreadPool* threads);

/// The picture of the iterations so far: whole blocks, and an open one. Iteration i is the i % B-th
/// of block i / B.
class Film {
  public:
    /// Begins with iteration 0 of block `first`.
    Film(int width, int height, BlockPlan plan = {}, std::uint64_t first = 0);

    /// Adds layers that are summed up as well; they must outlive the film. Called before the
    /// first iteration.
    void addLayers(BlockLayers& layers) { layers_.push_back(&layers); }
    /// Compares the halves of sums from now on (FilmSum::differences). `meter` must outlive the
    /// film. Called before the first iteration.
    void measure(const ErrorMeter& meter);

    /// Adds the next iteration: `pixels` are width * height values. A block's last
    /// iteration ends it.
    void add(std::span<const Rgb> pixels, const ThreadPool& threads);
    /// Adds the next iterations of the open block as a node of its tree. `threads` may be null.
    void add(SumTree::Node node, const ThreadPool* threads);

    int width() const { return width_; }
    int height() const { return height_; }
    /// Number of iterations added, from the first block on.
    std::uint64_t iterations() const { return iterations_; }
    /// Number of the next iteration.
    std::uint64_t nextIteration() const { return block_ * plan_.iterations + inBlock_; }
    /// Number of the open block, and how many of its iterations were added.
    std::uint64_t block() const { return block_; }
    std::uint64_t inBlock() const { return inBlock_; }

    /// The sum of all iterations. `threads` may be null.
    FilmSum sum(const ThreadPool* threads = nullptr, Layered layered = Layered::Yes) const;
    /// Likewise without layers.
    FilmSum pictureSum(const ThreadPool* threads = nullptr) const {
        return sum(threads, Layered::No);
    }
    Image image(const ThreadPool* threads = nullptr) const {
        return pictureSum(threads).image(width_, height_);
    }
    Image variance() const { return pictureSum().variance(width_, height_); }
    FilmSum::MeanColour meanColour() const { return pictureSum().meanColour(); }

    /// Sums from which a film can go on. A copy is a snapshot.
    struct State {
        std::vector<SumTree::Node> blocks;  ///< items are blocks
        std::uint64_t openBlock = 0;
        std::vector<SumTree::Node> open;  ///< items are iterations of the open block
    };
    /// The state to go on from. With `withOpen` it has the open block's iterations,
    /// without their layers.
    State state(bool withOpen) const;
    /// The state to be added to that of others. The open block's iterations are one node,
    /// with its layers.
    State finalState(const ThreadPool& threads) const;
    /// Goes on from the state of a film that had the same plan and began with the same block.
    /// Called before the first iteration.
    void restore(State state, const ThreadPool& threads);

  private:
    FilmSum openSum(const ThreadPool* threads, Layered layered = Layered::Yes) const;
    void measureOpen();

    int width_, height_;
    BlockPlan plan_;
    std::vector<BlockLayers*> layers_;
    const ErrorMeter* meter_ = nullptr;
    SumTree blocks_{1}, open_;
    std::uint64_t block_, inBlock_ = 0, iterations_ = 0;
};

}  // namespace lacuna

// A piece of a picture: some iterations of one block, which one rank makes and sends to rank 0.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "libcore/bidir/error_estimate.h"
#include "render/block_maker.h"
#include "render/part.h"

namespace lacuna {

/// The piece that a rank has to make.
struct Work {
    std::uint64_t begin = 0, count = 0;  ///< iterations, all of one block
    /// There is no picture to be saved yet: the first iteration is finished whatever happens.
    bool first = false;
};

class PieceMaker {
  public:
    /// All references must outlive the object. `interrupted` ends a piece in the middle of an
    /// iteration.
    PieceMaker(BlockMaker& maker, const ErrorMeter& meter, const PixelRect& crop,
               const std::atomic<bool>& interrupted, const ThreadPool& pool);

    /// Makes the iterations, as nodes of their block's tree, which is the part's open block. There
    /// are fewer after an interrupt, or if `stop`, called between two iterations, returns true.
    Part make(const Work& work, const std::function<bool()>& stop);

  private:
    BlockMaker& maker_;
    const ErrorMeter& meter_;
    const int width_, height_;
    const std::atomic<bool>& interrupted_;
    const ThreadPool& pool_;
    std::optional<std::uint64_t> open_;  ///< the open block
    std::vector<Rgb> pixels_;
};

std::vector<std::byte> bytesOf(const Part& part);
/// The inverse. Throws RunError for bytes that bytesOf did not make.
Part partOf(std::span<const std::byte> bytes);

}  // namespace lacuna

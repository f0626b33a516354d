#include "render/crew.h"

#include "render/stopwatch.h"

namespace lacuna {
namespace {
const std::atomic<bool> kNever{false};
}

Alone::Alone(BlockMaker& maker, const InterruptGuard& interrupt, const ThreadPool& pool,
             Progress& progress)
    : maker_(maker), interrupted_(interrupt.requested()), pool_(pool), progress_(progress) {}

bool Alone::advance(Film& film, Totals& totals) {
    if (stopped_) return false;
    const bool first = film.iterations() == 0;
    const std::atomic<bool>& cancel = first ? kNever : interrupted_;
    if (!begun_) {
        if (maker_.warmupIterations() > 0) progress_.phase("warm-up");
        Totals ofWarmUp;
        begun_ = maker_.beginBlock(film.block(), cancel, ofWarmUp);
        if (!begun_) return false;
        // A block's warm-up is counted once, whoever goes on in the middle of it.
        if (film.inBlock() == 0) totals.add(ofWarmUp);
        progress_.phase("rendering");
    }
    pixels_.resize(std::size_t(film.width()) * std::size_t(film.height()));
    Totals ofIteration;
    if (!maker_.render(film.nextIteration(), pixels_, cancel, ofIteration)) return false;
    {
        const Stopwatch watch(ofIteration.seconds);
        film.add(pixels_, pool_);
    }
    begun_ = film.inBlock() > 0;
    totals.add(ofIteration);
    iterationSeconds_ = iterationSeconds_ > 0.0 ? 0.5 * (iterationSeconds_ + ofIteration.seconds)
                                                : ofIteration.seconds;
    return true;
}

}  // namespace lacuna

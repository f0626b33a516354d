#include "render/crew.h"

#include "libcore/base/stopwatch.h"

namespace lacuna {

Alone::Alone(BlockMaker& maker, const InterruptGuard& interrupt, const ThreadPool& pool,
             Progress& progress)
    : maker_(maker), interrupted_(interrupt.requested()), pool_(pool), progress_(progress) {}

bool Alone::advance(Film& film, Totals& totals) {
    if (stopped_) return false;
    const bool first = film.iterations() == 0;
    const std::atomic<bool>& cancel = first ? kNeverCancelled : interrupted_;
    if (!begun_) {
        if (maker_.warmupIterations() > 0) progress_.phase("warm-up");
        begun_ = maker_.beginBlock(film.nextIteration(), cancel, totals);
        if (!begun_) return false;
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

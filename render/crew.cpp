#include "render/crew.h"

#include <algorithm>

#include "libcore/base/stopwatch.h"
#include "render/grace.h"

namespace lacuna {

Alone::Alone(BlockMaker& maker, const std::atomic<bool>& interrupted, const ThreadPool& pool,
             Progress& progress)
    : maker_(maker), interrupted_(interrupted), pool_(pool), progress_(progress) {}

bool Alone::advance(Film& film, Totals& totals) {
    if (stopped_ || cut_) return false;
    if (film.iterations() > 0) {
        // With layers an iteration must be finished: parts of it could not be removed from them.
        return make(film, totals, maker_.layers().empty() ? interrupted_ : kNeverCancelled);
    }
    bool made = false;
    {
        const Grace grace(interrupted_, cut_);
        made = make(film, totals, cut_);
    }
    if (made) cut_ = false;  // it was finished as the time ran out
    return made;
}

bool Alone::make(Film& film, Totals& totals, const std::atomic<bool>& cancel) {
    if (!begun_) {
        if (maker_.warmupIterations() > 0) progress_.phase("warm-up");
        begun_ = maker_.beginBlock(film.nextIteration(), cancel, totals);
        if (!begun_) return false;
        progress_.phase("rendering");
    }
    pixels_.resize(std::size_t(film.width()) * std::size_t(film.height()));
    Totals ofIteration;
    if (!maker_.render(film.nextIteration(), pixels_, cancel, ofIteration)) {
        if (cut_) addUnfinished(film);
        return false;
    }
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

/// Adds an unfinished iteration, but not with layers: their parts of the iteration are undefined.
void Alone::addUnfinished(Film& film) {
    const auto black = [](const Rgb& value) { return isBlack(value); };
    if (maker_.layers().empty() && !std::ranges::all_of(pixels_, black)) film.add(pixels_, pool_);
}

}  // namespace lacuna

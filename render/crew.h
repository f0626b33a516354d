// The makers of a picture's iterations: this process alone, or several together (render/ranks).
#pragma once

#include <atomic>
#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/tool/progress.h"
#include "render/block_maker.h"

namespace lacuna {

class Crew {
  public:
    virtual ~Crew() = default;
    /// Adds the next iterations, at most those of one block, to the film, and their statistics and
    /// time to `totals`. False if there are none, because of an interrupt or because they are not
    /// finished yet. Rethrows the exception that stopped a member of the crew.
    virtual bool advance(Film& film, Totals& totals) = 0;
    /// From now on, no new iterations begin.
    virtual void stop() = 0;
    /// Whether iterations are still being made.
    virtual bool busy() const { return false; }
    /// Whether another member was asked to end.
    virtual bool interrupted() const { return false; }
    /// Whether the first iteration was not finished in the time that an interrupt leaves it. The
    /// film then contains the unfinished iteration, or is empty if nothing was made.
    virtual bool cutShort() const { return false; }
    /// Time that a member takes for an iteration; 0: not known yet.
    virtual double iterationSeconds() const = 0;
};

/// A crew of one process. After an interrupt, the film's first iteration has three seconds to end,
/// so that there is something to save.
class Alone final : public Crew {
  public:
    /// All references must outlive the crew.
    Alone(BlockMaker& maker, const std::atomic<bool>& interrupted, const ThreadPool& pool,
          Progress& progress);
    bool advance(Film& film, Totals& totals) override;
    void stop() override { stopped_ = true; }
    bool cutShort() const override { return cut_; }
    double iterationSeconds() const override { return iterationSeconds_; }

  private:
    bool make(Film& film, Totals& totals, const std::atomic<bool>& cancel);
    void addUnfinished(Film& film);

    BlockMaker& maker_;
    const std::atomic<bool>& interrupted_;
    std::atomic<bool> cut_{false};
    const ThreadPool& pool_;
    Progress& progress_;
    bool stopped_ = false;
    bool begun_ = false;  ///< a block is open
    std::vector<Rgb> pixels_;
    double iterationSeconds_ = 0.0;
};

}  // namespace lacuna

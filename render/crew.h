// Who makes the iterations of a picture: this process alone, or several together (render/ranks).
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
    /// Adds the film's next iterations to it, those of one block at most, and to `totals` what they
    /// counted and the time that has gone. False: there are none, because of an interrupt or because
    /// they are not made yet. Throws what stopped a member of the crew.
    virtual bool advance(Film& film, Totals& totals) = 0;
    /// Nothing new begins from now on.
    virtual void stop() = 0;
    /// Whether something is still being made.
    virtual bool busy() const { return false; }
    /// Whether a member was asked to end, who is not asked here.
    virtual bool interrupted() const { return false; }
    /// Whether the first iteration was not finished in the time that an interrupt leaves it. The
    /// film then has what there is of it, as an iteration, or is empty where there is nothing.
    virtual bool cutShort() const { return false; }
    /// What a member takes for an iteration; 0: not known yet.
    virtual double iterationSeconds() const = 0;
};

/// One process. The film's first iteration has three seconds to end behind an interrupt, so that
/// there is something to save.
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
    bool begun_ = false;  ///< a block
    std::vector<Rgb> pixels_;
    double iterationSeconds_ = 0.0;
};

}  // namespace lacuna

// Several ranks make one picture: rank 0 gives out work and adds pieces to the film in the order of
// their iterations, so that the picture has the same bits as that of one process. (theory.md,
// "Blocks"; render/README.md, "Many machines")
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>

#include "render/crew.h"
#include "render/ranks/piece.h"
#include "render/ranks/ranks.h"

namespace lacuna {

/// How many of the next iterations a rank gets: whole blocks where that must be, else a node of the
/// block's tree that takes about `seconds`, and no picture past a count at which errors are looked at
/// (isMeasured).
/// `next`: the first of them; `end`: behind the last of the render, 0 if there is none.
std::uint64_t pieceSize(std::uint64_t next, std::uint64_t end, const BlockPlan& plan,
                        bool wholeBlocks, int ranks, double seconds, double iterationSeconds);

/// What rank 0 has of its own part of the work: a thread that makes pieces.
class LocalMember;

class Together final : public Crew {
  public:
    /// Behind which iteration and after how many seconds the render ends; 0: no end.
    struct Limits {
        std::uint64_t end = 0;
        double seconds = 0.0;
    };
    /// Of rank 0. All references must outlive the crew.
    Together(const Ranks& ranks, BlockMaker& maker, const ErrorMeter& meter, const PixelRect& crop,
             Limits limits, const std::atomic<bool>& interrupted, const ThreadPool& pool);
    /// Waits for all ranks and lets them end.
    ~Together() override;

    bool advance(Film& film, Totals& totals) override;
    void stop() override;
    bool busy() const override;
    bool interrupted() const override { return interrupted_; }
    double iterationSeconds() const override { return iterationSeconds_; }
    /// That came from other ranks.
    std::uint64_t receivedBytes() const { return receivedBytes_; }
    /// That rank 0 spent with reading and adding pieces.
    double piecesSeconds() const { return piecesSeconds_; }

  private:
    using Clock = std::chrono::steady_clock;

    bool receive();
    void take(int rank, Part part);
    void giveOut(const Film& film, double secondsSoFar);
    void end();

    const Ranks& ranks_;
    const Limits limits_;
    const std::atomic<bool>& interruptedHere_;
    const BlockPlan plan_;
    const bool wholeBlocks_;
    std::unique_ptr<LocalMember> local_;
    std::vector<std::optional<Work>> work_;  ///< by rank: what it is making
    std::map<std::uint64_t, Part> made_;     ///< not in the film yet, by their first iteration
    std::optional<std::uint64_t> next_;      ///< iteration to be given out
    bool stopped_ = false, interrupted_ = false;
    double iterationSeconds_ = 0.0;
    std::uint64_t receivedBytes_ = 0;
    double piecesSeconds_ = 0.0;
    Clock::time_point told_ = Clock::now();  ///< up to when time is counted
};

/// What ranks other than 0 do until rank 0 lets them end.
void serve(const Ranks& ranks, BlockMaker& maker, const ErrorMeter& meter, const PixelRect& crop,
           const std::atomic<bool>& interrupted, const ThreadPool& pool);

}  // namespace lacuna

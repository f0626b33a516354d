// Several ranks make one picture. Rank 0 distributes work and adds pieces to the film in the order
// of their iterations, so that the picture is bit for bit that of one process. (theory.md,
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

/// Number of the next iterations that a rank gets: whole blocks if necessary, else a node of the block's tree that
/// takes about `seconds`. A piece does not extend past a count at which errors are estimated (isMeasured). `next`: the
/// first iteration; `end`: one past the last of the render, 0 if there is no limit.
std::uint64_t pieceSize(std::uint64_t next, std::uint64_t end, const BlockPlan& plan,
                        bool wholeBlocks, int ranks, double seconds, double iterationSeconds);

/// Rank 0's own worker: a thread that makes pieces.
class LocalMember;

class Together final : public Crew {
  public:
    /// The end of the render: one past the last iteration, and seconds; 0: no limit.
    struct Limits {
        std::uint64_t end = 0;
        double seconds = 0.0;
    };
    /// For rank 0. All references must outlive the crew.
    Together(const Ranks& ranks, BlockMaker& maker, const ErrorMeter& meter, const PixelRect& crop,
             Limits limits, const std::atomic<bool>& interrupted, const ThreadPool& pool);
    /// Waits for all ranks and tells them to end.
    ~Together() override;

    bool advance(Film& film, Totals& totals) override;
    void stop() override;
    bool busy() const override;
    bool interrupted() const override { return interrupted_; }
    double iterationSeconds() const override { return iterationSeconds_; }
    /// Bytes received from other ranks.
    std::uint64_t receivedBytes() const { return receivedBytes_; }
    /// Time that rank 0 spent on reading and adding pieces.
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
    std::vector<std::optional<Work>> work_;  ///< by rank: its current piece
    std::map<std::uint64_t, Part> made_;     ///< not in the film yet, by first iteration
    std::optional<std::uint64_t> next_;      ///< next iteration to be distributed
    bool stopped_ = false, interrupted_ = false;
    double iterationSeconds_ = 0.0;
    std::uint64_t receivedBytes_ = 0;
    double piecesSeconds_ = 0.0;
    Clock::time_point told_ = Clock::now();  ///< time is counted up to here
};

/// The work of ranks other than 0, until rank 0 tells them to end.
void serve(const Ranks& ranks, BlockMaker& maker, const ErrorMeter& meter, const PixelRect& crop,
           const std::atomic<bool>& interrupted, const ThreadPool& pool);

}  // namespace lacuna

// The processes that mpirun started to make one picture: ranks 0, 1, .. Without MPI there is only
// one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lacuna {

class Ranks {
  public:
    /// Joins the other processes if a launcher started this one. Only one object may exist at a
    /// time, and only one thread may use it.
    Ranks();
    /// Selects a single process, whoever started it.
    struct Alone {};
    explicit Ranks(Alone) {}
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    int rank() const { return rank_; }
    int size() const { return int(machines_.size()); }
    /// Whether this is rank 0, which prints messages, writes the files and distributes the work.
    bool leads() const { return rank_ == 0; }
    bool many() const { return size() > 1; }
    /// "rank 2 (node7)"
    std::string name(int rank) const;

    /// Runs `stage` on every rank and waits for all of them. If it threw on any rank, rank 0 throws
    /// the error of the lowest such rank, with the rank's name. The other ranks return false: they
    /// should end silently.
    bool agree(const std::function<void()>& stage) const;

    enum class Tag { Inputs, Work, Piece, Failure, Stop, End };
    struct Letter {
        int from = 0;
        Tag tag = Tag::End;
        std::vector<std::byte> bytes;
    };
    /// Sends a letter. Returns when it is on its way; a long letter, when it has been received.
    void send(int to, Tag tag, std::span<const std::byte> bytes = {}) const;
    void send(int to, Tag tag, const std::string& text) const;
    /// A letter that has arrived, if there is one.
    std::optional<Letter> poll() const;
    /// Sleeps until a letter arrives.
    Letter wait() const;

  private:
    bool joined_ = false;
    int rank_ = 0;
    std::vector<std::string> machines_{""};  ///< names, by rank
};

/// The content of a letter as text.
std::string textOf(const Ranks::Letter& letter);

}  // namespace lacuna

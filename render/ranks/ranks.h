// The processes that mpirun started to make one picture: ranks 0, 1, .. Without MPI there is one.
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
    /// Joins the other processes where a launcher started this one; one object at a time, and one
    /// thread that uses it.
    Ranks();
    /// This process alone, whoever started it.
    struct Alone {};
    explicit Ranks(Alone) {}
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    int rank() const { return rank_; }
    int size() const { return int(machines_.size()); }
    /// Rank 0: it speaks for all, writes the files and gives out the work.
    bool leads() const { return rank_ == 0; }
    bool many() const { return size() > 1; }
    /// "rank 2 (node7)"
    std::string name(int rank) const;

    /// Runs `stage` on every rank and waits for all of them. Where it threw on any, rank 0 throws
    /// what the lowest of these threw, with its name; the others return false: they have nothing
    /// to say and should end.
    bool agree(const std::function<void()>& stage) const;

    enum class Tag { Inputs, Work, Piece, Failure, Stop, End };
    struct Letter {
        int from = 0;
        Tag tag = Tag::End;
        std::vector<std::byte> bytes;
    };
    /// Returns when the letter is on its way; long ones when they are read.
    void send(int to, Tag tag, std::span<const std::byte> bytes = {}) const;
    void send(int to, Tag tag, const std::string& text) const;
    /// A letter that has come, if there is one.
    std::optional<Letter> poll() const;
    /// Sleeps until there is one.
    Letter wait() const;

  private:
    bool joined_ = false;
    int rank_ = 0;
    std::vector<std::string> machines_{""};  ///< names, by rank
};

/// What a letter says.
std::string textOf(const Ranks::Letter& letter);

}  // namespace lacuna

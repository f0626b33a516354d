// An expression as a nondeterministic automaton, which is in several states at once [Thompson68].
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libcore/expression/parser.h"

namespace lacuna {

class Nfa {
  public:
    /// The set of its current states, ascending; only states with a transition on an event, or the last.
    using States = std::vector<std::uint32_t>;

    /// Empty if `most` states are not enough. The expression must outlive the automaton.
    static std::optional<Nfa> of(const Expression& root, std::size_t most);

    States start() const;
    States after(const States& states, const VertexEvent& event) const;
    /// Whether the events read so far match the whole expression.
    bool accepts(const States& states) const;

  private:
    using Index = std::uint32_t;
    struct State {
        const EventSet* events = nullptr;  ///< that lead to the state of the next index
        std::vector<Index> free = {};      ///< states reached without an event
    };

    explicit Nfa(std::size_t most) : most_(most) {}

    Index add(const EventSet* events = nullptr);
    Index append(const Expression& expression, Index from);
    Index appendRepeat(const Expression& expression, Index from);
    void reach(Index state, std::vector<bool>& reached) const;
    States statesOf(const std::vector<bool>& reached) const;

    std::size_t most_;
    bool overflows_ = false;
    std::vector<State> states_;
    Index last_ = 0;
};

}  // namespace lacuna

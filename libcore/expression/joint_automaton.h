// Several automata run as one: a step along a path costs the same for any number of expressions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/expression/automaton.h"

namespace lacuna {

class JointAutomaton {
  public:
    using State = std::uint16_t;
    using Letter = Automaton::Letter;
    static constexpr std::size_t kMostStates = 4096;

    /// Joins as many of the first automata as kMostStates states suffice for, at least one. All must be over the same
    /// alphabet. `first`: the number of the first automaton.
    JointAutomaton(std::span<const Automaton> automata, std::uint32_t first);

    /// Number of automata that are joined.
    std::size_t size() const { return size_; }
    std::size_t states() const { return settled_.size(); }
    State start() const { return 0; }
    State next(State state, Letter scattering) const {
        return next_[state * letters_ + scattering];
    }
    /// The automata that accept a path that has reached `state` and ends on this light: first + i
    /// for the i-th one.
    std::span<const std::uint32_t> accepted(State state, Letter light) const {
        const std::size_t at = state * lights_ + light;
        return std::span(accepted_).subspan(begin_[at], begin_[at + 1] - begin_[at]);
    }
    /// Whether no event but that of the light can change the outcome any more.
    bool settled(State state) const { return settled_[state]; }

  private:
    std::size_t size_ = 0, letters_, lights_;
    std::vector<State> next_;              // by state and letter of scattering
    std::vector<std::uint8_t> settled_;    // by state
    std::vector<std::uint32_t> accepted_;  // by state and letter of lights, one after the other
    std::vector<std::size_t> begin_;       // of each list in accepted_
};

}  // namespace lacuna

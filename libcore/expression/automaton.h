// An expression as a minimal deterministic automaton that reads a path from the camera to the
// light.
// (theory.md, "Layers of paths")
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/expression/parser.h"

namespace lacuna {

/// All events that are possible in a scene: at the vertices between camera and light, and at the light. Letters are
/// indices into these.
struct Alphabet {
    std::vector<VertexEvent> scattering, lights;
};

class Automaton {
  public:
    using State = std::uint16_t;
    using Letter = std::uint16_t;
    static constexpr std::size_t kMostStates = 1000;

    /// Throws UsageError, whose message begins with `what`, if more than kMostStates are needed, or
    /// if no path from the camera to a light matches.
    Automaton(const Expression& expression, const Alphabet& alphabet, const std::string& what);

    std::size_t states() const { return settled_.size(); }
    /// Number of scattering events in the alphabet.
    std::size_t letters() const { return letters_; }
    std::size_t lights() const { return lights_; }
    /// The state after the camera.
    State start() const { return 0; }
    State next(State state, Letter scattering) const {
        return next_[state * letters_ + scattering];
    }
    /// Whether a path that has reached `state` and ends on this light matches.
    bool accepts(State state, Letter light) const { return accepts_[state * lights_ + light]; }
    /// Whether no event but that of the light can change the outcome any more.
    bool settled(State state) const { return settled_[state]; }

  private:
    std::size_t letters_, lights_;
    std::vector<State> next_;            // by state and letter of `scattering`
    std::vector<std::uint8_t> accepts_;  // by state and letter of `lights`
    std::vector<std::uint8_t> settled_;  // by state
};

}  // namespace lacuna

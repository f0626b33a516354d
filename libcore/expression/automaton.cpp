#include "libcore/expression/automaton.h"

#include <algorithm>
#include <map>
#include <optional>

#include "libcore/base/error.h"
#include "libcore/expression/nfa.h"

namespace lacuna {

namespace {

/// One state: which lights it accepts, and the state that each letter leads to.
struct DfaState {
    std::vector<std::uint8_t> accepts;
    std::vector<std::size_t> next;

    auto operator<=>(const DfaState&) const = default;
};
using Dfa = std::vector<DfaState>;

/// The subset construction [Rabin59]: each set of states that `nfa` can be in becomes one state.
/// The first one follows the camera. Empty if more than `most` states are needed.
std::optional<Dfa> subsetsOf(const Nfa& nfa, const Alphabet& alphabet, std::size_t most) {
    std::map<Nfa::States, std::size_t> indices;
    std::vector<Nfa::States> sets;
    const auto indexOf = [&](Nfa::States set) {
        const auto [entry, isNew] = indices.try_emplace(std::move(set), sets.size());
        if (isNew) sets.push_back(entry->first);
        return entry->second;
    };
    indexOf(nfa.after(nfa.start(), VertexEvent{}));
    Dfa dfa;
    while (dfa.size() < sets.size()) {
        if (sets.size() > most) return std::nullopt;
        const Nfa::States set = sets[dfa.size()];
        DfaState state;
        for (const VertexEvent& light : alphabet.lights) {
            state.accepts.push_back(nfa.accepts(nfa.after(set, light)));
        }
        for (const VertexEvent& event : alphabet.scattering) {
            state.next.push_back(indexOf(nfa.after(set, event)));
        }
        dfa.push_back(std::move(state));
    }
    return dfa;
}

/// Merges equivalent states [Moore56]: classes of states are split by what their states accept and
/// by the classes that they lead to, until no class splits.
Dfa minimal(const Dfa& dfa) {
    std::vector<std::size_t> classOf(dfa.size(), 0);
    for (std::size_t classes = 0;;) {
        std::map<std::pair<std::size_t, DfaState>, std::size_t> indices;
        std::vector<std::size_t> finer;
        Dfa result;
        for (std::size_t i = 0; i < dfa.size(); ++i) {
            DfaState state = dfa[i];
            for (std::size_t& next : state.next) next = classOf[next];
            const auto [entry, isNew] = indices.try_emplace({classOf[i], state}, result.size());
            if (isNew) result.push_back(state);
            finer.push_back(entry->second);
        }
        if (result.size() == classes) return result;
        classes = result.size();
        classOf = std::move(finer);
    }
}

}  // namespace

Automaton::Automaton(const Expression& expression, const Alphabet& alphabet,
                     const std::string& what)
    : letters_(alphabet.scattering.size()), lights_(alphabet.lights.size()) {
    constexpr std::size_t kMostOfNfa = 4 * kMostStates;
    const std::optional<Nfa> nfa = Nfa::of(expression, kMostOfNfa);
    const std::optional<Dfa> subsets = nfa ? subsetsOf(*nfa, alphabet, kMostStates) : std::nullopt;
    if (!subsets) {
        throw UsageError(what + ": expected an automaton of at most " +
                         std::to_string(kMostStates) + " states, found more; repeat less");
    }
    const Dfa dfa = minimal(*subsets);
    bool matchesSomething = alphabet.lights.empty();
    for (std::size_t i = 0; i < dfa.size(); ++i) {
        const auto& [accepts, next] = dfa[i];
        accepts_.insert(accepts_.end(), accepts.begin(), accepts.end());
        for (const std::size_t n : next) next_.push_back(State(n));
        settled_.push_back(std::ranges::all_of(next, [&](std::size_t n) { return n == i; }));
        matchesSomething = matchesSomething || std::ranges::count(accepts, 1) > 0;
    }
    if (!matchesSomething) {
        throw UsageError(what +
                         ": expected the way from the camera to a light, such as C<RD>L or C.*B, "
                         "found none that matches here");
    }
}

}  // namespace lacuna

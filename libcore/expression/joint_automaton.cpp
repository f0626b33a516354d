#include "libcore/expression/joint_automaton.h"

#include <map>
#include <optional>

namespace lacuna {

namespace {

/// One state of each automaton.
using Tuple = std::vector<Automaton::State>;

struct Product {
    std::vector<Tuple> states;
    std::vector<std::uint16_t> next;  ///< by state and letter
};

/// The product of the automata: the tuples of states that they can be in together, the start first.
/// Empty if there are more than `most`.
std::optional<Product> productOf(std::span<const Automaton> automata, std::size_t most) {
    std::map<Tuple, std::size_t> indices;
    Product product;
    const auto indexOf = [&](const Tuple& tuple) {
        const auto [entry, isNew] = indices.try_emplace(tuple, product.states.size());
        if (isNew) product.states.push_back(tuple);
        return entry->second;
    };
    Tuple tuple;
    for (const Automaton& automaton : automata) tuple.push_back(automaton.start());
    indexOf(tuple);
    for (std::size_t state = 0; state < product.states.size(); ++state) {
        if (product.states.size() > most) return std::nullopt;
        for (std::size_t letter = 0; letter < automata.front().letters(); ++letter) {
            for (std::size_t i = 0; i < automata.size(); ++i) {
                tuple[i] = automata[i].next(product.states[state][i], Automaton::Letter(letter));
            }
            product.next.push_back(std::uint16_t(indexOf(tuple)));
        }
    }
    return product;
}

}  // namespace

JointAutomaton::JointAutomaton(std::span<const Automaton> automata, std::uint32_t first)
    : letters_(automata.front().letters()), lights_(automata.front().lights()) {
    std::optional<Product> product;
    while (size_ < automata.size()) {
        std::optional<Product> larger = productOf(automata.first(size_ + 1), kMostStates);
        if (!larger) break;
        product = std::move(larger);
        ++size_;
    }
    next_ = std::move(product->next);
    begin_.push_back(0);
    for (std::size_t state = 0; state < product->states.size(); ++state) {
        bool settled = true;
        for (std::size_t i = 0; i < letters_; ++i) {
            settled = settled && next_[state * letters_ + i] == state;
        }
        settled_.push_back(settled);
        for (std::size_t light = 0; light < lights_; ++light) {
            for (std::size_t i = 0; i < size_; ++i) {
                if (automata[i].accepts(product->states[state][i], Automaton::Letter(light))) {
                    accepted_.push_back(first + std::uint32_t(i));
                }
            }
            begin_.push_back(accepted_.size());
        }
    }
}

}  // namespace lacuna

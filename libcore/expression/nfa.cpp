#include "libcore/expression/nfa.h"

namespace lacuna {

std::optional<Nfa> Nfa::of(const Expression& root, std::size_t most) {
    Nfa nfa(most);
    nfa.last_ = nfa.append(root, nfa.add());
    if (nfa.overflows_) return std::nullopt;
    return nfa;
}

/// Adds a state and returns its index. If there are too many, it adds none and returns 0.
Nfa::Index Nfa::add(const EventSet* events) {
    overflows_ = overflows_ || states_.size() == most_;
    if (overflows_) return 0;
    states_.push_back({events});
    return Index(states_.size() - 1);
}

/// Appends the expression to the state `from`. Returns the state after it.
Nfa::Index Nfa::append(const Expression& expression, Index from) {
    switch (expression.kind) {
        case Expression::Kind::Events: {
            const Index before = add(&expression.events);
            states_[from].free.push_back(before);
            return add();  // the next index: the events lead to this state
        }
        case Expression::Kind::Sequence:
            for (const Expression& part : expression.parts) from = append(part, from);
            return from;
        case Expression::Kind::Either: {
            std::vector<Index> ends;
            for (const Expression& part : expression.parts) ends.push_back(append(part, from));
            const Index end = add();
            for (const Index e : ends) states_[e].free.push_back(end);
            return end;
        }
        case Expression::Kind::Repeat:
            return appendRepeat(expression, from);
    }
    return from;
}

Nfa::Index Nfa::appendRepeat(const Expression& expression, Index from) {
    const Expression& part = expression.parts.front();
    for (int i = 0; i < expression.least && !overflows_; ++i) from = append(part, from);
    if (!expression.most) {
        // The loop has a beginning of its own, so that it does not lead back to what stands before
        // it.
        const Index begin = add();
        states_[from].free.push_back(begin);
        const Index end = append(part, begin);
        states_[end].free.push_back(begin);
        return begin;
    }
    std::vector<Index> ends{from};
    for (int i = expression.least; i < *expression.most && !overflows_; ++i) {
        const Index begin = add();
        states_[ends.back()].free.push_back(begin);
        ends.push_back(append(part, begin));
    }
    const Index end = add();
    for (const Index e : ends) states_[e].free.push_back(end);
    return end;
}

void Nfa::reach(Index state, std::vector<bool>& reached) const {
    States open{state};
    while (!open.empty()) {
        const Index next = open.back();
        open.pop_back();
        if (reached[next]) continue;
        reached[next] = true;
        open.insert(open.end(), states_[next].free.begin(), states_[next].free.end());
    }
}

Nfa::States Nfa::statesOf(const std::vector<bool>& reached) const {
    States result;
    for (Index i = 0; i < states_.size(); ++i) {
        if (reached[i] && (states_[i].events || i == last_)) result.push_back(i);
    }
    return result;
}

Nfa::States Nfa::start() const {
    std::vector<bool> reached(states_.size());
    reach(0, reached);
    return statesOf(reached);
}

Nfa::States Nfa::after(const States& states, const VertexEvent& event) const {
    std::vector<bool> reached(states_.size());
    for (const Index i : states) {
        if (states_[i].events && states_[i].events->matches(event)) reach(i + 1, reached);
    }
    return statesOf(reached);
}

bool Nfa::accepts(const States& states) const {
    return !states.empty() && std::ranges::find(states, last_) != states.end();
}

}  // namespace lacuna

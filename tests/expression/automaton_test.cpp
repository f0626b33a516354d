// Automata of light path expressions against the regular expressions of the standard library.
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <regex>

#include "libcore/base/error.h"
#include "libcore/expression/automaton.h"
#include "libcore/expression/joint_automaton.h"
#include "tests/expression/two_objects.h"

namespace lacuna::test {
namespace {

using Type = EventType;
using Scatter = Scattering;

Automaton compiled(const std::string& text, const Alphabet& alphabet = twoObjects()) {
    return Automaton(parseExpression(text, text).root, alphabet, text);
}

/// All events, each of which has a character of its own in regular expressions: the camera,
/// scattering, lights.
std::vector<VertexEvent> allEvents(const Alphabet& alphabet) {
    std::vector<VertexEvent> all{VertexEvent{}};
    all.insert(all.end(), alphabet.scattering.begin(), alphabet.scattering.end());
    all.insert(all.end(), alphabet.lights.begin(), alphabet.lights.end());
    return all;
}

bool isCalled(const VertexEvent& e, const std::string& name) {
    return std::ranges::find(e.names, name) != e.names.end();
}
bool isLight(const VertexEvent& e) {
    return e.type == Type::Lamp || e.type == Type::Mesh || e.type == Type::Environment;
}

/// Events in the notation, and what they mean.
struct Meaning {
    const char* text;
    std::function<bool(const VertexEvent&)> matches;
};
const std::vector<Meaning>& meanings() {
    using E = const VertexEvent&;
    static const std::vector<Meaning> all = {
        {".", [](E) { return true; }},
        {"C", [](E e) { return e.type == Type::Camera; }},
        {"R", [](E e) { return e.type == Type::Reflection; }},
        {"T", [](E e) { return e.type == Type::Transmission; }},
        {"L", [](E e) { return isLight(e); }},
        {"O", [](E e) { return e.type == Type::Mesh; }},
        {"B", [](E e) { return e.type == Type::Environment; }},
        {"D", [](E e) { return e.scattering == Scatter::Diffuse; }},
        {"G", [](E e) { return e.scattering == Scatter::Glossy; }},
        {"S", [](E e) { return e.scattering == Scatter::Singular; }},
        {"s", [](E) { return false; }},
        {"'a'", [](E e) { return isCalled(e, "a"); }},
        {"<R>", [](E e) { return e.type == Type::Reflection; }},
        {"<RD>",
         [](E e) { return e.type == Type::Reflection && e.scattering == Scatter::Diffuse; }},
        {"<TS>",
         [](E e) { return e.type == Type::Transmission && e.scattering == Scatter::Singular; }},
        {"<.G>", [](E e) { return e.scattering == Scatter::Glossy; }},
        {"<.[GS]>",
         [](E e) { return e.scattering == Scatter::Glossy || e.scattering == Scatter::Singular; }},
        {"<[RT][^D]>",
         [](E e) {
             return (e.type == Type::Reflection || e.type == Type::Transmission) &&
                    e.scattering != Scatter::Diffuse;
         }},
        {"<R.'a'>", [](E e) { return e.type == Type::Reflection && isCalled(e, "a"); }},
        {"<[^C].[^'a']>", [](E e) { return e.type != Type::Camera && !isCalled(e, "a"); }},
        {"<L.['a''b']>", [](E e) { return isLight(e) && !e.names.empty(); }},
        {"[DS]",
         [](E e) { return e.scattering == Scatter::Diffuse || e.scattering == Scatter::Singular; }},
        {"[^G]", [](E e) { return e.scattering != Scatter::Glossy; }},
        {"[^<RD>B]",
         [](E e) {
             return !(e.type == Type::Reflection && e.scattering == Scatter::Diffuse) &&
                    e.type != Type::Environment;
         }},
    };
    return all;
}

/// An expression in both notations.
struct Both {
    std::string text, regex;
};

class RandomExpressions {
  public:
    explicit RandomExpressions(const Alphabet& alphabet) : events_(allEvents(alphabet)) {}

    std::size_t upTo(std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n)(random_);
    }

    Both next(int depth) {
        const std::size_t kind = depth == 0 ? 0 : upTo(5);
        if (kind <= 1) return event(meanings()[upTo(meanings().size() - 1)]);
        const Both a = next(depth - 1);
        if (kind == 2) {
            constexpr const char* kRepeats[] = {"*", "+", "?", "{2}", "{0,2}", "{1,3}", "{2,}"};
            const std::string repeat = kRepeats[upTo(6)];
            return {"(" + a.text + ")" + repeat, "(?:" + a.regex + ")" + repeat};
        }
        const Both b = next(depth - 1);
        if (kind == 3)
            return {"(" + a.text + "|" + b.text + ")", "(?:" + a.regex + "|" + b.regex + ")"};
        return {a.text + b.text, a.regex + b.regex};
    }

  private:
    Both event(const Meaning& meaning) const {
        std::string characters;
        for (std::size_t i = 0; i < events_.size(); ++i) {
            if (meaning.matches(events_[i])) characters += char('a' + i);
        }
        // The standard library has no empty class.
        return {meaning.text, characters.empty() ? "!" : "[" + characters + "]"};
    }

    std::vector<VertexEvent> events_;
    std::mt19937 random_{7};
};

TEST(ExpressionAutomaton, MatchesWhatTheStandardLibraryMatches) {
    const Alphabet alphabet = twoObjects();
    const std::size_t scatterings = alphabet.scattering.size();
    RandomExpressions random(alphabet);
    std::size_t matches = 0, matchless = 0;
    for (int i = 0; i < 1500; ++i) {
        Both both = random.next(4);
        if (random.upTo(3) > 0) both = {"C" + both.text, "a" + both.regex};
        if (random.upTo(3) > 0) both = {both.text + ".*L", both.regex + ".*[lmno]"};
        std::optional<Automaton> automaton;
        try {
            automaton.emplace(parseExpression(both.text, "").root, alphabet, "");
        } catch (const UsageError&) {
            ++matchless;
        }
        const std::regex regex(both.regex);
        for (int path = 0; path < 40; ++path) {
            std::string characters = "a";
            Automaton::State state = 0;
            for (std::size_t n = random.upTo(5); n > 0; --n) {
                const auto letter = Automaton::Letter(random.upTo(scatterings - 1));
                if (automaton) state = automaton->next(state, letter);
                characters += char('b' + letter);
            }
            const auto light = Automaton::Letter(random.upTo(alphabet.lights.size() - 1));
            characters += char('b' + scatterings + light);
            const bool expected = std::regex_match(characters, regex);
            ASSERT_EQ(automaton && automaton->accepts(state, light), expected)
                << both.text << " on " << characters;
            matches += expected ? 1 : 0;
        }
    }
    EXPECT_GT(matches, 5000u);
    EXPECT_LT(matches, 55000u);
    EXPECT_GT(matchless, 20u);
    EXPECT_LT(matchless, 750u);
}

TEST(ExpressionAutomaton, HasNoStateTooMany) {
    EXPECT_EQ(compiled("C.*L").states(), 1u);
    EXPECT_EQ(compiled(".*").states(), 1u);
    EXPECT_EQ(compiled("C(D|[^D])*(B|[^B])").states(), 1u);
    EXPECT_EQ(compiled("CL").states(), 2u);
    EXPECT_EQ(compiled("C<RD>L").states(), 3u);
    EXPECT_EQ(compiled("C.*<TS>.*L").states(), 2u);
    EXPECT_EQ(compiled("C(.*<TS>.*|.*<TS>.*<RD>.*)L").states(), 2u);
}

TEST(ExpressionAutomaton, KnowsWhenAllIsSettled) {
    const Automaton automaton = compiled("C.*<TS>.*L");
    EXPECT_FALSE(automaton.settled(automaton.start()));
    EXPECT_TRUE(automaton.settled(automaton.next(automaton.start(), 4)));
    EXPECT_TRUE(compiled("C.*L").settled(0));
    EXPECT_FALSE(compiled("C(..)*L").settled(0));
}

void expectRefused(const std::string& text, const std::string& part) {
    try {
        compiled(text);
        ADD_FAILURE() << text << " is an automaton";
    } catch (const UsageError& e) {
        EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
}

TEST(ExpressionAutomaton, RefusesWhatGrowsTooLarge) {
    const std::string tooMany = "expected an automaton of at most 1000 states, found more";
    // Remembers which of the last ones were diffuse: 2^n states.
    EXPECT_EQ(compiled("C.*D.{6}L").states(), 128u);
    expectRefused("C.*D.{12}L", tooMany);
    expectRefused("C((((D{1000}){1000}){1000}){1000}){1000}L", tooMany);
    expectRefused("C.{1000}L", tooMany);
    EXPECT_EQ(compiled("C.{254}L").states(), 256u);
}

TEST(ExpressionAutomaton, RefusesWhatNoPathMatches) {
    for (const char* text :
         {"L.*C", "D", "CD", "DL", "CsL", "CLL", "C<RD'c'>L", "C<TD>L", "C<LD>"}) {
        expectRefused(text, "expected the way from the camera to a light, such as C<RD>L or C.*B");
    }
}

TEST(JointExpressions, AcceptWhatEachOfThemAccepts) {
    const Alphabet alphabet = twoObjects();
    std::vector<Automaton> automata;
    for (const char* text : {"C.*L", "C<RD>L", "C.*<TS>.*L", "CD{3}.*B", "C(..)*O", "C.*'a'"}) {
        automata.push_back(compiled(text, alphabet));
    }
    const JointAutomaton joint(automata, 10);
    ASSERT_EQ(joint.size(), automata.size());
    std::mt19937 random(3);
    for (int path = 0; path < 3000; ++path) {
        JointAutomaton::State state = joint.start();
        std::vector<Automaton::State> states(automata.size(), 0);
        bool settled = joint.settled(state);
        for (std::size_t n = random() % 6; n > 0; --n) {
            const auto letter = Automaton::Letter(random() % alphabet.scattering.size());
            const JointAutomaton::State before = state;
            state = joint.next(state, letter);
            ASSERT_TRUE(!settled || state == before);
            settled = joint.settled(state);
            for (std::size_t i = 0; i < automata.size(); ++i) {
                states[i] = automata[i].next(states[i], letter);
            }
        }
        const auto light = Automaton::Letter(random() % alphabet.lights.size());
        std::vector<std::uint32_t> expected;
        for (std::size_t i = 0; i < automata.size(); ++i) {
            if (automata[i].accepts(states[i], light)) expected.push_back(10 + std::uint32_t(i));
        }
        const auto found = joint.accepted(state, light);
        ASSERT_EQ(std::vector<std::uint32_t>(found.begin(), found.end()), expected);
    }
}

TEST(JointExpressions, AreAsManyAsThereIsRoomFor) {
    std::vector<Automaton> automata;
    for (const char* text : {"C.*L", "C.*D.{7}L", "C.*G.{7}L", "CL"}) {
        automata.push_back(compiled(text));
    }
    const JointAutomaton first(automata, 0);
    EXPECT_EQ(first.size(), 2u);
    EXPECT_EQ(first.states(), 256u);
    EXPECT_EQ(JointAutomaton(std::span(automata).subspan(2), 2).size(), 2u);
}

TEST(ExpressionAutomaton, WithoutLightsThereIsNothingToMatch) {
    Alphabet dark = twoObjects();
    dark.lights.clear();
    EXPECT_EQ(compiled("C<RD>L", dark).states(), 1u);
}

}  // namespace
}  // namespace lacuna::test

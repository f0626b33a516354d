#include <sstream>

#include "libcore/expression/joint_automaton.h"
#include "tests/fuzz/attempt.h"

namespace lacuna::test {
namespace {

/// Whatever a vertex can do, at an object without a name and at one called `a`, and lights of each kind.
Alphabet everyEvent() {
    using enum EventType;
    Alphabet alphabet;
    for (const std::vector<std::string>& names : {std::vector<std::string>{}, {"a"}}) {
        for (const EventType type : {Reflection, Transmission}) {
            for (const Scattering s :
                 {Scattering::Diffuse, Scattering::Glossy, Scattering::Singular}) {
                alphabet.scattering.push_back({type, s, names});
            }
        }
        for (const EventType type : {Lamp, Mesh, Environment}) {
            alphabet.lights.push_back({type, Scattering::None, names});
        }
    }
    return alphabet;
}

}  // namespace

bool acceptsExpressions(Bytes bytes) {
    static const Alphabet alphabet = everyEvent();
    return attempt([&] {
        std::istringstream text(std::string(bytes.begin(), bytes.end()));
        std::vector<Automaton> automata;
        for (std::string line; std::getline(text, line);) {
            std::erase(line, '\0');  // no command line can hold one
            const std::string what = "--layer a=" + line;
            automata.emplace_back(parseExpression(line, what).root, alphabet, what);
        }
        const std::span<const Automaton> all(automata);
        for (std::size_t done = 0; done < all.size();) {
            done += JointAutomaton(all.subspan(done), std::uint32_t(done)).size();
        }
    });
}

}  // namespace lacuna::test

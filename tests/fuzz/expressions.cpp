#include <sstream>

#include "libcore/expression/joint_automaton.h"
#include "tests/expression/two_objects.h"
#include "tests/fuzz/attempt.h"

namespace lacuna::test {

bool acceptsExpressions(Bytes bytes) {
    static const Alphabet alphabet = twoObjects();
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

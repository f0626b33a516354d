// An alphabet for tests of expressions.
#pragma once

#include "libcore/expression/automaton.h"

namespace lacuna::test {

/// Two objects, one of which is called `a`; a lamp, a lamp `a`, a mesh `b` and the environment.
inline Alphabet twoObjects() {
    Alphabet alphabet;
    for (const std::vector<std::string>& names : {std::vector<std::string>{}, {"a"}}) {
        for (const Scattering s : {Scattering::Diffuse, Scattering::Glossy, Scattering::Singular}) {
            alphabet.scattering.push_back({EventType::Reflection, s, names});
            if (s == Scattering::Diffuse) continue;
            alphabet.scattering.push_back({EventType::Transmission, s, names});
        }
    }
    alphabet.lights = {{EventType::Lamp, Scattering::None, {}},
                       {EventType::Lamp, Scattering::None, {"a"}},
                       {EventType::Mesh, Scattering::None, {"b"}},
                       {EventType::Environment, Scattering::None, {}}};
    return alphabet;
}

}  // namespace lacuna::test

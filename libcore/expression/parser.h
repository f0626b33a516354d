// Light path expressions [Heckbert90] in the notation of OSL, from text to tree:
//
//     either     = sequence { '|' sequence }
//     sequence   = { repeated }+
//     repeated   = ( '(' either ')' | events ) { '*' | '+' | '?' | '{' n [ ',' [ m ] ] '}' }
//     events     = pattern | '[' [ '^' ] { pattern }+ ']'
//     pattern    = '.' | type | scattering | name | '<' types [ scatterings [ names ] ] '>'
//     type       = C | R | T | L | O | B          scattering = D | G | S | s
//     name = a quote, the name of something in the scene, a quote
//
// types, scatterings, names: '.', one of them, or several in brackets: [RT], [^D], ['lamp''sun'].
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "libcore/expression/event.h"

namespace lacuna {

/// A regular expression over events.
struct Expression {
    enum class Kind : std::uint8_t { Events, Sequence, Either, Repeat };
    Kind kind = Kind::Sequence;
    EventSet events = {};                ///< for Events
    std::vector<Expression> parts = {};  ///< for the other kinds; Repeat has one
    int least = 0;                       ///< for Repeat: number of repetitions
    std::optional<int> most = {};        ///< likewise; empty: any number
};

/// A name in an expression, and the number of the character at which it stands; the first is 1.
struct NameMention {
    std::string name;
    std::size_t position = 0;
};

struct ParsedExpression {
    Expression root;
    std::vector<NameMention> names;  ///< in the order of the text
};

/// The longest text and the largest number of repetitions that are accepted.
inline constexpr std::size_t kMostCharacters = 1000;
inline constexpr int kMostRepetitions = 1000;

/// Throws UsageError, whose message begins with `what` and names the character.
ParsedExpression parseExpression(const std::string& text, const std::string& what);

}  // namespace lacuna

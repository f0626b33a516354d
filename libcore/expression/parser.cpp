#include "libcore/expression/parser.h"

#include <array>
#include <string_view>
#include <utility>

#include "libcore/base/error.h"

namespace lacuna {

namespace {

/// A letter of the notation and the set of values that it denotes.
struct Letter {
    char character;
    Bits bits;
};
constexpr Bits kLights =
    bitOf(EventType::Lamp) | bitOf(EventType::Mesh) | bitOf(EventType::Environment);
constexpr std::array kTypes = {
    Letter{'C', bitOf(EventType::Camera)},       Letter{'R', bitOf(EventType::Reflection)},
    Letter{'T', bitOf(EventType::Transmission)}, Letter{'L', kLights},
    Letter{'O', bitOf(EventType::Mesh)},         Letter{'B', bitOf(EventType::Environment)}};
// s, straight: a ray that alpha lets through has no vertex here, so that this event never occurs.
constexpr std::array kScatterings = {
    Letter{'D', bitOf(Scattering::Diffuse)}, Letter{'G', bitOf(Scattering::Glossy)},
    Letter{'S', bitOf(Scattering::Singular)}, Letter{'s', Bits(0)}};

constexpr const char* kEvent =
    "an event (C, R, T, L, O, B, D, G, S, s, ., <...>, [...] or a name in quotes)";
constexpr const char* kType = "a type (C, R, T, L, O, B or .)";
constexpr const char* kScattering = "a scattering letter (D, G, S, s or .)";
constexpr const char* kName = "a name in quotes, or .";

bool continuesCharacter(char byte) {
    return (static_cast<unsigned char>(byte) & 0xc0u) == 0x80u;  // UTF-8
}

class Parser {
  public:
    Parser(std::string_view text, std::string_view what) : text_(text), what_(what) {}

    ParsedExpression parse() {
        result_.root = either();
        if (!atEnd()) fail("an event or the end");
        return std::move(result_);
    }

  private:
    bool atEnd() const { return at_ == text_.size(); }
    bool sees(char c) const { return !atEnd() && text_[at_] == c; }
    bool taken(char c) {
        if (!sees(c)) return false;
        ++at_;
        return true;
    }
    void require(char c) {
        if (!taken(c)) fail(std::string(1, c));
    }

    /// Number of the character that begins here; the first is 1.
    std::size_t position() const {
        std::size_t before = 0;
        for (const char c : text_.substr(0, at_)) before += continuesCharacter(c) ? 0 : 1;
        return before + 1;
    }
    [[noreturn]] void fail(const std::string& expected) const {
        std::string found = "the end";
        if (!atEnd()) {
            std::size_t end = at_ + 1;
            while (end < text_.size() && continuesCharacter(text_[end])) ++end;
            found = "\"" + std::string(text_.substr(at_, end - at_)) + "\"";
        }
        throw UsageError(std::string(what_) + ": position " + std::to_string(position()) +
                         ": expected " + expected + ", found " + found);
    }

    Expression either() {
        Expression all{Expression::Kind::Either};
        do {
            all.parts.push_back(sequence());
        } while (taken('|'));
        return all;
    }

    Expression sequence() {
        Expression all{Expression::Kind::Sequence};
        do {
            all.parts.push_back(repeated());
        } while (!atEnd() && !sees('|') && !sees(')'));
        return all;
    }

    Expression repeated() {
        Expression one = atom();
        for (;;) {
            if (taken('*')) {
                one = repeat(std::move(one), 0, std::nullopt);
            } else if (taken('+')) {
                one = repeat(std::move(one), 1, std::nullopt);
            } else if (taken('?')) {
                one = repeat(std::move(one), 0, 1);
            } else if (taken('{')) {
                const int least = number(0);
                std::optional<int> most = least;
                if (taken(',')) most = sees('}') ? std::nullopt : std::optional(number(least));
                require('}');
                one = repeat(std::move(one), least, most);
            } else {
                return one;
            }
        }
    }

    static Expression repeat(Expression what, int least, std::optional<int> most) {
        Expression all{Expression::Kind::Repeat};
        all.parts.push_back(std::move(what));
        all.least = least;
        all.most = most;
        return all;
    }

    int number(int least) {
        const std::size_t start = at_;
        int value = 0;
        while (!atEnd() && text_[at_] >= '0' && text_[at_] <= '9' && value <= kMostRepetitions) {
            value = 10 * value + (text_[at_++] - '0');
        }
        if (at_ == start || value < least || value > kMostRepetitions) {
            at_ = start;
            fail("a number from " + std::to_string(least) + " to " +
                 std::to_string(kMostRepetitions));
        }
        return value;
    }

    Expression atom() {
        if (taken('(')) {
            Expression inner = either();
            require(')');
            return inner;
        }
        Expression one{Expression::Kind::Events};
        if (!taken('[')) {
            one.events.any.push_back(pattern());
            return one;
        }
        one.events.negated = taken('^');
        do {
            one.events.any.push_back(pattern());
        } while (!atEnd() && !sees(']'));
        require(']');
        return one;
    }

    EventPattern pattern() {
        EventPattern result;
        if (taken('.')) return result;
        if (taken('<')) return withinBrackets();
        if (sees('\'')) {
            result.names = {false, {name()}};
            return result;
        }
        if (const Letter* type = letterOf(kTypes)) {
            result.types = type->bits;
        } else if (const Letter* scattering = letterOf(kScatterings)) {
            result.scatterings = scattering->bits;
        } else {
            fail(kEvent);
        }
        return result;
    }

    EventPattern withinBrackets() {
        EventPattern result;
        result.types = bits(kTypes, kType);
        if (taken('>')) return result;
        result.scatterings = bits(kScatterings, kScattering);
        if (taken('>')) return result;
        result.names = names();
        require('>');
        return result;
    }

    /// Consumes one of the letters if it comes next; otherwise returns null.
    template <std::size_t n>
    const Letter* letterOf(const std::array<Letter, n>& table) {
        for (const Letter& letter : table) {
            if (taken(letter.character)) return &letter;
        }
        return nullptr;
    }

    template <std::size_t n>
    Bits bits(const std::array<Letter, n>& table, const char* expected) {
        const auto one = [&] {
            const Letter* letter = letterOf(table);
            if (!letter) fail(expected);
            return letter->bits;
        };
        if (taken('.')) return kEveryBit;
        if (!taken('[')) return one();
        const bool negated = taken('^');
        Bits all = 0;
        do {
            all |= one();
        } while (!taken(']'));
        return negated ? ~all : all;
    }

    NamePattern names() {
        if (taken('.')) return {};
        if (!taken('[')) return {false, {name()}};
        NamePattern all{taken('^'), {}};
        do {
            all.any.push_back(name());
        } while (!taken(']'));
        return all;
    }

    std::string name() {
        if (!sees('\'')) fail(kName);
        const std::size_t quoteAt = position(), start = ++at_;
        while (!atEnd() && text_[at_] != '\'') ++at_;
        const std::string name(text_.substr(start, at_ - start));
        require('\'');
        result_.names.push_back({name, quoteAt + 1});
        return name;
    }

    std::string_view text_, what_;
    std::size_t at_ = 0;
    ParsedExpression result_;
};

}  // namespace

ParsedExpression parseExpression(const std::string& text, const std::string& what) {
    if (text.size() > kMostCharacters) {
        throw UsageError(what + ": expected at most " + std::to_string(kMostCharacters) +
                         " characters, found " + std::to_string(text.size()));
    }
    return Parser(text, what).parse();
}

}  // namespace lacuna

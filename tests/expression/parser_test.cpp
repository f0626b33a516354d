// Texts that are no light path expression are refused, with the position of the character.
#include <gtest/gtest.h>

#include "libcore/base/error.h"
#include "libcore/expression/parser.h"

namespace lacuna::test {
namespace {

std::string refusal(const std::string& text) {
    try {
        parseExpression(text, "--layer x=" + text);
    } catch (const UsageError& e) {
        return e.what();
    }
    return "";
}

void expectRefused(const std::string& text, const std::string& why) {
    EXPECT_EQ(refusal(text), "--layer x=" + text + ": " + why);
}

TEST(ExpressionParser, PointsAtTheCharacter) {
    const std::string event =
        "expected an event (C, R, T, L, O, B, D, G, S, s, ., <...>, [...] or a name in quotes), ";
    const std::string type = "expected a type (C, R, T, L, O, B or .), ";
    const std::string scattering = "expected a scattering letter (D, G, S, s or .), ";
    const std::string name = "expected a name in quotes, or ., ";
    expectRefused("C<TX>L", "position 4: " + scattering + "found \"X\"");
    expectRefused("", "position 1: " + event + "found the end");
    expectRefused("CxL", "position 2: " + event + "found \"x\"");
    expectRefused("C*L)", "position 4: expected an event or the end, found \")\"");
    expectRefused("C(D", "position 4: expected ), found the end");
    expectRefused("C()", "position 3: " + event + "found \")\"");
    expectRefused("C|", "position 3: " + event + "found the end");
    expectRefused("*C", "position 1: " + event + "found \"*\"");
    expectRefused("C[", "position 3: " + event + "found the end");
    expectRefused("C[]L", "position 3: " + event + "found \"]\"");
    expectRefused("C[D", "position 4: expected ], found the end");
    expectRefused("C<", "position 3: " + type + "found the end");
    expectRefused("C<>", "position 3: " + type + "found \">\"");
    expectRefused("C<D>", "position 3: " + type + "found \"D\"");
    expectRefused("C<R'a'>", "position 4: " + scattering + "found \"'\"");
    expectRefused("C<RD'a'D>", "position 8: expected >, found \"D\"");
    expectRefused("C<RDx>", "position 5: " + name + "found \"x\"");
    expectRefused("C<RD'lamp>L", "position 12: expected ', found the end");
    expectRefused("C<[R", "position 5: " + type + "found the end");
    expectRefused("C<R[^]>", "position 6: " + scattering + "found \"]\"");
    expectRefused("C{x}", "position 3: expected a number from 0 to 1000, found \"x\"");
    expectRefused("C{1001}", "position 3: expected a number from 0 to 1000, found \"1\"");
    expectRefused("C{99999999999999999999}",
                  "position 3: expected a number from 0 to 1000, found \"9\"");
    expectRefused("C{3,2}", "position 5: expected a number from 3 to 1000, found \"2\"");
    expectRefused("C{3", "position 4: expected }, found the end");
    // Positions count characters, not bytes.
    expectRefused(
        "C'M\xc3\xb6"
        "bel'\xc3\xa4",
        "position 9: " + event + "found \"\xc3\xa4\"");
}

TEST(ExpressionParser, SaysWhereNamesStand) {
    const std::vector<NameMention> names = parseExpression(
                                               "C<RD'fl\xc3\xb6"
                                               "or'><L.[^'a''the sun']>",
                                               "")
                                               .names;
    ASSERT_EQ(names.size(), 3u);
    EXPECT_EQ(names[0].name,
              "fl\xc3\xb6"
              "or");
    EXPECT_EQ(names[0].position, 6u);
    EXPECT_EQ(names[1].name, "a");
    EXPECT_EQ(names[1].position, 19u);
    EXPECT_EQ(names[2].name, "the sun");
    EXPECT_EQ(names[2].position, 22u);
}

TEST(ExpressionParser, BoundsItsWork) {
    EXPECT_EQ(refusal(std::string(1000, '(')).substr(1000 + 12),
              "position 1001: expected an event "
              "(C, R, T, L, O, B, D, G, S, s, ., <...>, [...] or a name in quotes), found the end");
    expectRefused(std::string(1001, '*'), "expected at most 1000 characters, found 1001");
    EXPECT_EQ(refusal("C" + std::string(999, '*')), "");
}

}  // namespace
}  // namespace lacuna::test

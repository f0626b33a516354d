// Names out of foreign files, as messages show them.
#include "libcore/base/printable.h"

#include <gtest/gtest.h>

namespace lacuna::test {
namespace {

TEST(Printable, IsOneLineOfUtf8) {
    EXPECT_EQ(printable("a lamp"), "a lamp");
    EXPECT_EQ(printable("a\n\x1b[31mb\x7f"), "a  [31mb ");
    const std::string words = "T\u00fcr \u6249 \U0001F6AA";
    EXPECT_EQ(printable(words), words);
    EXPECT_EQ(printable("\xff"
                        "a\xc3"),
              "?a?");
    EXPECT_EQ(printable("\xc0\xaf"), "??") << "longer than need be";
    EXPECT_EQ(printable("\xed\xa0\x80"), "???") << "half of a character";
    EXPECT_EQ(printable("\xf4\x90\x80\x80"), "????") << "beyond the last one";
}

TEST(Printable, IsCutBetweenCharacters) {
    EXPECT_EQ(printable("abc", 3), "abc");
    EXPECT_EQ(printable("abcd", 3), "abc...");
    EXPECT_EQ(printable("ab\u00fc", 3), "ab...");
    EXPECT_EQ(printable(std::string(10, '\xff'), 3), "???...");
}

}  // namespace
}  // namespace lacuna::test

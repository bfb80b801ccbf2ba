#include "base/text.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(Text, TrimsBothEnds) {
    EXPECT_EQ(trim(" \t a b\t "), "a b");
    EXPECT_EQ(trim("a\r"), "a\r");
    EXPECT_EQ(trim("a\r", " \r"), "a");
    EXPECT_EQ(trim(" \t"), "");
    EXPECT_EQ(trim(""), "");
}

TEST(Text, TrimsQuotes) {
    EXPECT_EQ(trimQuoted(" \"0.4 mm\"\r"), "0.4 mm");
    EXPECT_EQ(trimQuoted("\"\""), "");
}

TEST(Text, PutsLinesOnOne) {
    EXPECT_EQ(onOneLine("a\r\nb\tc\x1b[0m\x7f"), "a  b c [0m ");
    EXPECT_EQ(onOneLine("Gr\xc3\xbcn"), "Gr\xc3\xbcn");
    EXPECT_EQ(onOneLine(""), "");
}

TEST(Text, ChangesTheCaseOfAsciiAlone) {
    EXPECT_EQ(lowerCase('Z'), 'z');
    EXPECT_EQ(lowerCase('['), '[');
    EXPECT_EQ(upperCase('a'), 'A');
    EXPECT_EQ(upperCase('{'), '{');
    EXPECT_EQ(lowerCase(std::string("Grün.PNG")), "grün.png");
    EXPECT_EQ(upperCase(std::string("vdb2\xc3\xbc")), "VDB2\xc3\xbc");
}

}  // namespace
}  // namespace stratum

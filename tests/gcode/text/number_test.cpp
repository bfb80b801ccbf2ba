#include "gcode/text/number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>

namespace stratum::gcode {
namespace {

struct NumberCase {
    std::string_view text;
    double value;
    std::string_view rest;  // what is left unread
};

TEST(Number, GrammarOfGcode) {
    constexpr NumberCase kCases[] = {
        {"1", 1, ""},
        {"-1", -1, ""},
        {"+1.5", 1.5, ""},
        {".3", 0.3, ""},
        {"-.25", -0.25, ""},
        {"5.", 5, ""},
        {"007", 7, ""},
        {"1E5", 1, "E5"},                    // the words 1 and E5
        {"1e-3", 1, "e-3"},                  //
        {"1.5308e-15Y3", 1.5308e-15, "Y3"},  // as Python writes it
        {"-1e-05", -1e-5, ""},
        {"2e+10", 2e10, ""},
        {"1e-999 ", 0, " "},
        {"10e-05.5", 10, "e-05.5"},  // the words 10 and e-05.5
        {"2.5Y3", 2.5, "Y3"},
        {"1.2.3", 1.2, ".3"},
        {"0x10", 0, "x10"},
        {"1,5", 1, ",5"},
        {"3-4", 3, "-4"},
        {"0.1", 0.1, ""},
        {"123.456", 123.456, ""},
        {"9007199254740993", 9007199254740992.0, ""},        // 2^53 + 1: beyond the fast path
        {"0.1000000000000000055511151231257827", 0.1, ""},   // 0.1's own digits
        {"00000000000000000000000000000000001.5", 1.5, ""},  // more digits than a 64-bit mantissa
        {"-123456789012345678901234567890", -1.2345678901234568e29, ""},
    };
    for (const NumberCase& c : kCases) {
        const char* p = c.text.data();
        const char* const end = p + c.text.size();
        double value = -77;
        ASSERT_TRUE(parseNumber(p, end, value)) << c.text;
        EXPECT_EQ(value, c.value) << c.text;
        EXPECT_EQ(std::string_view(p, static_cast<std::size_t>(end - p)), c.rest) << c.text;
    }
}

TEST(Number, WhatIsNone) {
    for (const std::string_view text : {"", "-", "+", ".", "-.", "+.", "nan", "-inf", "INF", "E5", " 1", "--1", "x"}) {
        const char* p = text.data();
        double value = -77;
        EXPECT_FALSE(parseNumber(p, p + text.size(), value)) << text;
        EXPECT_EQ(p, text.data()) << text;
        EXPECT_EQ(value, -77) << text;
    }
}

TEST(Number, MoreThanADoubleHoldsIsInfinite) {
    const std::string digits(400, '9');
    const char* p = digits.data();
    double value = 0;
    ASSERT_TRUE(parseNumber(p, p + digits.size(), value));
    EXPECT_TRUE(std::isinf(value));
}

TEST(Number, NegativeZeroKeepsItsSign) {
    const std::string_view text = "-0.0";
    const char* p = text.data();
    double value = 1;
    ASSERT_TRUE(parseNumber(p, p + text.size(), value));
    EXPECT_TRUE(value == 0 && std::signbit(value));
}

}  // namespace
}  // namespace stratum::gcode

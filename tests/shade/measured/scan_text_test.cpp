#include "shade/measured/scan_text.h"

#include "base/error.h"
#include "refusal.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::ScanText;

TEST(ScanText, ReadsLinesCommentsAndNumbers) {
    ScanText text("# a note\r\n\r\n  KEY: 3 \r\n1\t2,3;\n+4 5e-1\n", "t");
    std::string_view line;
    ASSERT_TRUE(text.next(line));
    EXPECT_EQ(shade::splitKeyword(line).key, "KEY");
    EXPECT_EQ(shade::splitKeyword(line).value, "3");
    EXPECT_EQ(shade::countOf(text, "3", "count", 1, 5), 3u);
    EXPECT_EQ(text.numbers(5, "numbers"), (std::vector<double>{1, 2, 3, 4, 0.5}));
    EXPECT_EQ(text.comments().at(0), "a note");
    EXPECT_FALSE(text.next(line));
}

TEST(ScanText, ErrorsNameTheLine) {
    ScanText text("1 2\n3 x\n", "part.bsdf");
    EXPECT_TRUE(test::refuses<InputError>("part.bsdf: line 2", [&] { text.numbers(4, "a reading"); }));
    ScanText many("1 2 3\n", "t");
    EXPECT_THROW(many.numbers(2, "pairs"), InputError);
    ScanText few("1 2 3\n", "t");
    EXPECT_THROW(few.numbers(4, "readings"), InputError);
    for (const char* count : {"0", "6", "1.5", "", "two", "1 2"})
        EXPECT_THROW(shade::countOf(few, count, "count", 1, 5), InputError) << count;
    EXPECT_THROW(few.parse("inf", "a number"), InputError);
}

}  // namespace
}  // namespace stratum

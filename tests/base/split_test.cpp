#include "base/text.h"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace stratum {
namespace {

using Pieces = std::vector<std::string_view>;

TEST(Split, HasAPieceMoreThanSeparators) {
    EXPECT_EQ(split(""), Pieces{""});
    EXPECT_EQ(split("a"), Pieces{"a"});
    EXPECT_EQ(split("a,,b,"), (Pieces{"a", "", "b", ""}));
    EXPECT_EQ(split("a b,c", ' '), (Pieces{"a", "b,c"}));
}

TEST(Split, AListMayBeEmptyAndEndWithASeparator) {
    EXPECT_EQ(splitList(""), Pieces{});
    EXPECT_EQ(splitList("a,b"), (Pieces{"a", "b"}));
    EXPECT_EQ(splitList("a,b,"), (Pieces{"a", "b"}));
    EXPECT_EQ(splitList(","), Pieces{""});
}

}  // namespace
}  // namespace stratum

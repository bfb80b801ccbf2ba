#include "base/names.h"

#include <gtest/gtest.h>

#include <string_view>

namespace stratum {
namespace {

enum class Fruit { apple, pear };
constexpr Names<Fruit, 2> kFruits = {{{"apple", Fruit::apple}, {"pear", Fruit::pear}}};

TEST(Names, AreFoundBothWays) {
    EXPECT_EQ(valueOf(kFruits, "pear"), Fruit::pear);
    EXPECT_FALSE(valueOf(kFruits, "Pear"));
    EXPECT_FALSE(valueOf(kFruits, ""));
    EXPECT_EQ(nameOf(kFruits, Fruit::apple), "apple");
    EXPECT_EQ(listOf(kFruits)[1], "pear");
}

}  // namespace
}  // namespace stratum

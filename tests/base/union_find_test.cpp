#include "base/union_find.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(UnionFind, TheLowestNumberLeads) {
    UnionFind sets(6);
    EXPECT_TRUE(sets.join(5, 3));
    EXPECT_TRUE(sets.join(3, 1));
    EXPECT_FALSE(sets.join(1, 5));
    EXPECT_EQ(sets.find(5), 1U);
    EXPECT_EQ(sets.find(2), 2U);
}

}  // namespace
}  // namespace stratum

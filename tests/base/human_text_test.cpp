#include "base/human_text.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(HumanText, ChoosesTheUnit) {
    EXPECT_EQ(humanBytes(789), "789 B");
    EXPECT_EQ(humanBytes(1e3), "1.0 kB");
    EXPECT_EQ(humanBytes(45.61e6), "45.6 MB");
    EXPECT_EQ(humanBytes(1.234e9), "1.23 GB");
    EXPECT_EQ(humanCount(9999), "9999");
    EXPECT_EQ(humanCount(45600), "45.6 k");
    EXPECT_EQ(humanCount(12.34e6), "12.3 M");
}

TEST(HumanText, OneAndMany) {
    EXPECT_EQ(counted(0, "bead"), "0 beads");
    EXPECT_EQ(counted(1, "bead"), "1 bead");
    EXPECT_EQ(counted(2, "bead"), "2 beads");
}

}  // namespace
}  // namespace stratum

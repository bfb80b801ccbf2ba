#include "gcode/toolpath/toolpath.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

TEST(DepositModel, CornersAreNoLargerThanHalfTheHeight) {
    DepositModel deposit;
    EXPECT_EQ(deposit.cornerRadius(0.2), 0.1);
    deposit.corner_fraction = 0.5;
    EXPECT_EQ(deposit.cornerRadius(0.2), 0.05);
    deposit.corner_mm = 0.08;
    EXPECT_EQ(deposit.cornerRadius(0.2), 0.08);
    EXPECT_EQ(deposit.cornerRadius(0.1), 0.05);
    deposit.corner_mm = 0;
    EXPECT_EQ(deposit.cornerRadius(0.2), 0);
}

TEST(DepositModel, IsDescribedInWords) {
    DepositModel deposit;
    EXPECT_EQ(describe(deposit), "capsule, stadium");
    deposit.corner_fraction = 0.5;
    EXPECT_EQ(describe(deposit), "capsule, corners of 50 % of half the height");
    deposit.beads = DepositModel::Beads::settled;
    deposit.corner_mm = 0.05;
    EXPECT_EQ(describe(deposit), "settled, corners of 0.05 mm");
}

}  // namespace
}  // namespace stratum::gcode

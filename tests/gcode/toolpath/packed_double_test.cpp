#include "gcode/toolpath/packed_double.h"

#include "gcode/toolpath/toolpath.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stratum::gcode {
namespace {

TEST(PackedDouble, HoldsEveryBit) {
    for (const double value : {0.0, -0.0, 0.1, -1e300, 4e-310, std::numeric_limits<double>::infinity(), 123456.789}) {
        const PackedDouble packed = value;
        EXPECT_EQ(double{packed}, value);
        EXPECT_EQ(std::signbit(double{packed}), std::signbit(value));
    }
    EXPECT_TRUE(std::isnan(PackedDouble(std::nan(""))));
    EXPECT_EQ(double{PackedDouble{}}, 0);
}

TEST(PackedDouble, CountsAsADoubleDoes) {
    PackedDouble value = 1.5;
    value += 2;
    value *= 4;
    value -= 1;
    EXPECT_EQ(value, 13.0);
    EXPECT_LT(value, 13.5);
}

TEST(PackedDouble, LeavesNoHolesInABead) { EXPECT_EQ(sizeof(Bead), 60U); }

}  // namespace
}  // namespace stratum::gcode

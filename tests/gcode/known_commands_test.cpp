#include "gcode/known_commands.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

TEST(KnownCommands, HarmlessOnesOfEverySlicersStart) {
    for (const int code : {73,  84,  104, 105, 106, 107, 109, 115, 117, 140, 141, 190,
                           201, 203, 204, 205, 220, 302, 400, 555, 569, 572, 862, 900})
        EXPECT_TRUE(isHarmless('M', code)) << code;
    for (const int code : {4, 29, 53, 80}) EXPECT_TRUE(isHarmless('G', code)) << code;
}

TEST(KnownCommands, OthersAreWorthARemark) {
    for (const int code : {206, 218, 290 + 1000, 98765}) EXPECT_FALSE(isHarmless('M', code)) << code;
    for (const int code : {18, 19, 54, 81, 93, 12345}) EXPECT_FALSE(isHarmless('G', code)) << code;
}

}  // namespace
}  // namespace stratum::gcode

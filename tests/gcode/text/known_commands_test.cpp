#include "gcode/text/known_commands.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

TEST(KnownCommands, HarmlessOnesOfEverySlicersStart) {
    for (const int code : {73,  84,  104, 105, 106, 107, 109, 115, 117, 140, 141, 190,
                           201, 203, 204, 205, 220, 302, 400, 555, 569, 572, 862, 900})
        EXPECT_TRUE(isHarmless('M', code)) << code;
    for (const int code : {4, 11, 29, 80}) EXPECT_TRUE(isHarmless('G', code)) << code;
}

TEST(KnownCommands, OthersAreWorthARemark) {
    for (const int code : {206, 219, 290 + 1000, 98765}) EXPECT_FALSE(isHarmless('M', code)) << code;
    for (const int code : {18, 19, 54, 81, 93, 12345}) EXPECT_FALSE(isHarmless('G', code)) << code;
}

TEST(KnownCommands, NamedOnes) {
    for (const auto* name : {"SET_PRESSURE_ADVANCE", "bed_mesh_profile", "EXCLUDE_OBJECT_DEFINE", "TURN_OFF_HEATERS"})
        EXPECT_TRUE(isHarmlessMacro(name)) << name;
    for (const auto* name : {"PRINT_START", "EXCLUDE_OBJECT", "FORCE_MOVE", "SET_GCODE_OFFSET", ""})
        EXPECT_FALSE(isHarmlessMacro(name)) << name;
}

}  // namespace
}  // namespace stratum::gcode

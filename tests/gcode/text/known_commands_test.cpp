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

TEST(KnownCommands, OfSingleMakers) {
    for (const int code : {38, 39, 65, 130, 150, 161, 162, 280, 383, 392, 425, 2814, 9111})
        EXPECT_TRUE(isHarmless('G', code)) << code;
    for (const int code : {108, 132, 137, 322, 650, 729, 863, 1020, 1704, 6211, 7219, 8213, 9140, 9201, 10086, 12001})
        EXPECT_TRUE(isHarmless('M', code)) << code;
    for (const int code : {3006, 3290}) EXPECT_TRUE(isHarmless('M', code)) << code;  // 3DGence
    for (const auto* name : {"END_PRINT", "set_tmc_current", "SET_GCODE_VARIABLE", "PAUSE"})
        EXPECT_TRUE(isHarmlessMacro(name)) << name;
}

}  // namespace
}  // namespace stratum::gcode

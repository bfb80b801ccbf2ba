#include "gcode/machine/extra_axes.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

TEST(ExtraAxes, TheBedSinksByW) {
    const Toolpath toolpath = readProgram("M83\nW-500 X0\nG1 Z.3\nG1 X9 E1\nG1 W-500.3\nG1 X0 E1\nG1 Z.6\nG1 X9 E1\n");
    ASSERT_EQ(toolpath.beads.size(), 3U);
    EXPECT_NEAR(toolpath.beads[0].z1, 0.3, 1e-9);  // where W stood at first is where the print begins
    EXPECT_NEAR(toolpath.beads[1].z1, 0.6, 1e-9);
    EXPECT_NEAR(toolpath.beads[2].z1, 0.9, 1e-9);
    EXPECT_EQ(toolpath.layer_count, 3U);
    EXPECT_EQ(warningCount(toolpath, "W lowers the bed"), 1U);
}

TEST(ExtraAxes, IncrementsAndNewNamesOfW) {
    const Toolpath toolpath =
        readProgram("M83\nG1 Z.3\nG1 X9 E1\nG92 W5\nG1 W4.7\nG1 X0 E1\nG91\nM83\nG1 W-.3\nG90\nM83\nG1 X9 E1\n");
    ASSERT_EQ(toolpath.beads.size(), 3U);
    EXPECT_NEAR(toolpath.beads[1].z1, 0.6, 1e-9);
    EXPECT_NEAR(toolpath.beads[2].z1, 0.9, 1e-9);
}

TEST(ExtraAxes, ABedIsNotDrivenIntoTheNozzle) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.3\nG1 X9 E1\nG1 X0 W10 E1\nG1 X9 E1\n");
    ASSERT_EQ(toolpath.beads.size(), 3U);
    for (const Bead& bead : toolpath.beads) EXPECT_NEAR(bead.z1, 0.3, 1e-9);
    EXPECT_EQ(warningCount(toolpath, "W would move the bed into the nozzle"), 1U);
}

TEST(ExtraAxes, WhatTurnsThePartIsRefused) {
    const std::string program = "M83\nG1 Z.2\nG1 X9 E1\nG0 B30\nG0 X20\nG1 X30 C5 E1\n";
    const std::string message = inputErrorOf(program);
    EXPECT_NE(message.find("test.gcode:6: B and C turn the part or the nozzle"), std::string::npos) << message;
    EXPECT_NE(message.find("--planar"), std::string::npos) << message;
    ReadOptions options;
    options.planar = true;
    const Toolpath toolpath = readProgram(program, options);
    EXPECT_EQ(toolpath.beads.size(), 2U);
    EXPECT_EQ(warningCount(toolpath, "B and C turn the part or the nozzle, which is not followed"), 1U);
}

TEST(ExtraAxes, WhatStaysIsNoMatter) {
    // A constant angle turns everything alike; a turn between prints that comes back changes nothing.
    const Toolpath toolpath =
        readProgram("M83\nG0 A30 C-90\nG1 Z.2\nG1 X9 A30 E1\nG0 C0\nG0 C-90\nG92 A0\nG1 X0 A0 E1\nG1 X9 E1\n");
    EXPECT_EQ(toolpath.beads.size(), 3U);
    EXPECT_EQ(warningCount(toolpath, "turn"), 0U);
}

TEST(ExtraAxes, AxesBesideXAndYAreSaid) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nG1 X9 E1\nG1 X20 U5 V2 E1\n");
    EXPECT_EQ(toolpath.beads.size(), 2U);
    EXPECT_EQ(warningCount(toolpath, "U and V are not followed"), 1U);
}

TEST(ExtraAxes, MakerBotsExtrudersAreNoAxes) {
    const Toolpath toolpath = readProgram("G1 Z.2\nG1 X9 A1\nG1 X0 A2\nG92 B0\nG1 X9 B1\n");
    EXPECT_EQ(toolpath.beads.size(), 3U);
    EXPECT_EQ(warningCount(toolpath, "turn"), 0U);
}

TEST(ExtraAxes, SharesOfFilamentsAreNoAngles) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nG1 X9 E1 A.25 B.75\nG1 X0 E1 A.5 B.5\n");
    EXPECT_EQ(toolpath.beads.size(), 2U);
    EXPECT_EQ(warningCount(toolpath, "turn"), 0U);
    EXPECT_EQ(warningCount(toolpath, "mixes filaments"), 1U);
}

}  // namespace
}  // namespace stratum::gcode

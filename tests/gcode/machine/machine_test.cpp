#include "gcode/machine/machine.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

// A Cura file with "Z82" for "Z.2": the rest of that layer lies 75 mm above the print.
TEST(Machine, ALineThatClimbsFarIsTold) {
    const std::string head =
        ";Generated with Cura_SteamEngine 5.4.0\n;Layer height: 0.2\nM82\n;LAYER:0\nG0 X10 Y10 Z.2\n";
    const auto warnings = [&](const std::string& rest) {
        return warningCount(readProgram(head + "G1 X50 Y10 E1.33\n" + rest + ";End of Gcode\n"), "is its Z damaged?");
    };
    EXPECT_EQ(warnings("G1 X50 Y50 Z82 E2.66\nG1 X10 Y50 E3.99\n"), 1U);
    EXPECT_EQ(warnings("G1 X50 Y50 Z.4 E2.66\nG1 X55 Y50 Z5 E3\n"), 0U);
}

void expectStart(const Bead& bead, double x, double y, double z) {
    EXPECT_NEAR(bead.x0, x, 1e-12);
    EXPECT_NEAR(bead.y0, y, 1e-12);
    EXPECT_NEAR(bead.z0, z, 1e-12);
}

void expectEnd(const Bead& bead, double x, double y, double z) {
    EXPECT_NEAR(bead.x1, x, 1e-12);
    EXPECT_NEAR(bead.y1, y, 1e-12);
    EXPECT_NEAR(bead.z1, z, 1e-12);
}

TEST(Machine, AbsoluteByDefault) {
    const Toolpath toolpath = readProgram("G1 X20 Y20 Z.2 F3000\nG1 X20 Y10 E2\nG1 X10 Y10 E3\n");
    ASSERT_EQ(toolpath.beads.size(), 2U);
    expectStart(toolpath.beads[0], 20, 20, 0.2);
    expectEnd(toolpath.beads[0], 20, 10, 0.2);
    expectEnd(toolpath.beads[1], 10, 10, 0.2);
    EXPECT_DOUBLE_EQ(toolpath.filament_mm, 3);
    EXPECT_NEAR(toolpath.extruded_mm3, 3 * kFilamentArea, 1e-12);
    EXPECT_NEAR(volumeOf(toolpath, toolpath.beads[0]), 2 * kFilamentArea, 1e-5);
    EXPECT_EQ(toolpath.lineOf(toolpath.beads[0]), 2U);
    EXPECT_EQ(toolpath.runs[0].speed, 50.0F);
    EXPECT_EQ(toolpath.firmware, "marlin");
    EXPECT_EQ(warningCount(toolpath, "neither M82 nor M83"), 1U);
    EXPECT_EQ(warningCount(readProgram(";FLAVOR:UltiGCode\nG1 X9 Z.2 E1\nG1 X9 Y9 E2\n"), "neither M82"), 0U);
}

TEST(Machine, G0ExtrudesToo) { EXPECT_EQ(readProgram("M83\nG0 Z.2\nG0 X9 E1\n").beads.size(), 1U); }

TEST(Machine, WhatIsNoBead) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\nG1 E5 ; prime\nG1 Z1 E1 ; ooze\nG1 Z.2\nG1 X1 E1\nG1 X2\nG1 X3 E-1 ; wipe\nG1 E1\nG1 X4 E0\n");
    EXPECT_EQ(toolpath.beads.size(), 1U);
    EXPECT_DOUBLE_EQ(toolpath.filament_mm, 1);
}

TEST(Machine, RelativeMoves) {
    const Toolpath toolpath = readProgram("M83\nG1 X5 Y5 Z.2\nG91\nM83\nG1 X1 E1\nG1 Y2 E1\nG90\nM83\nG1 X0 Y0 E1\n");
    ASSERT_EQ(toolpath.beads.size(), 3U);
    expectEnd(toolpath.beads[0], 6, 5, 0.2);
    expectEnd(toolpath.beads[1], 6, 7, 0.2);
    expectEnd(toolpath.beads[2], 0, 0, 0.2);
}

TEST(Machine, G91TurnsEOnlyInMarlin) {
    // Marlin: E2 after G91 is an increment. Klipper, RepRapFirmware: still absolute, from 3 back to 2.
    const std::string_view program = "M82\nG1 Z.2\nG1 X1 E3\nG91\nG1 X1 E2\n";
    ReadOptions options;
    EXPECT_DOUBLE_EQ(readProgram(program, options).filament_mm, 5);
    options.firmware = Firmware::klipper;
    EXPECT_DOUBLE_EQ(readProgram(program, options).filament_mm, 3);
    options.firmware = Firmware::reprap;
    EXPECT_DOUBLE_EQ(readProgram(program, options).filament_mm, 3);
    EXPECT_EQ(readProgram(program, options).firmware, "reprap");
}

TEST(Machine, G90AfterM83) {
    const std::string program = "M83\nG90\nG1 Z.2\nG1 X1 E1\nG1 X2 E1\n";
    EXPECT_DOUBLE_EQ(readProgram(program).filament_mm, 1);  // Marlin 2: absolute again, and E stays at 1
    EXPECT_DOUBLE_EQ(readProgram(program + "; gcode_flavor = klipper\n").filament_mm, 2);
    // The slicer says that it writes increments, so its G90 did not mean E.
    EXPECT_DOUBLE_EQ(readProgram(program + "; use_relative_e_distances = 1\n").filament_mm, 2);
}

TEST(Machine, WithoutM82OrM83TheSettingsDecide) {
    const std::string program = "G1 Z.2\nG1 X1 E1\nG1 X2 E1\n";
    EXPECT_DOUBLE_EQ(readProgram(program).filament_mm, 1);
    const Toolpath relative = readProgram(program + "; use_relative_e_distances = 1\n");
    EXPECT_DOUBLE_EQ(relative.filament_mm, 2);
    EXPECT_EQ(warningCount(relative, "neither"), 0U);
    ReadOptions options;
    options.extruder_mode = ExtruderMode::relative;
    EXPECT_DOUBLE_EQ(readProgram(program, options).filament_mm, 2);
    EXPECT_DOUBLE_EQ(readProgram("M82\n" + program, options).filament_mm, 1);  // the file has the last word
}

TEST(Machine, OffsetsOfToolsAreAdded) {
    ReadOptions options;
    options.tool_offsets = toolOffsetsOf("0x0,18x-1", "--tool-offsets");
    const std::string program = "M83\nG1 Z.2\nG1 X10 E1\nT1\nG1 X-8 Y1 E1\nG1 X2 Y1 E1\n";
    for (const std::string& settings : {std::string(), std::string("; extruder_offset = 0x0,5x5\n")}) {
        const Toolpath toolpath = readProgram(program + settings, options);
        expectStart(toolpath.beads.back(), 10, 0, 0.2);
        expectEnd(toolpath.beads.back(), 20, 0, 0.2);
    }
    for (const char* bad : {"", "18", "0,18", "0x0,18x", "0x0,18xa", "0x0,1001x0", "nanx0", "0x0,18x0x1"})
        EXPECT_THROW(toolOffsetsOf(bad, "--tool-offsets"), UsageError) << bad;
}

TEST(Machine, G92OfE) {
    EXPECT_DOUBLE_EQ(readProgram("M82\nG1 Z.2\nG1 X1 E5\nG92 E0\nG1 X2 E1\nG92 E10\nG1 X3 E12\n").filament_mm, 8);
    EXPECT_DOUBLE_EQ(readProgram("M82\nG1 Z.2\nG1 X1 E5\nG92 E\nG1 X2 E1\n").filament_mm, 6);
}

TEST(Machine, G92BeforeTheFirstBeadNamesThePlace) {
    const Toolpath toolpath = readProgram("M83\nG1 X5 Y5 Z10\nG92 X0 Y0 Z.2\nG1 X1 E1\n");
    expectStart(toolpath.beads[0], 0, 0, 0.2);
    expectEnd(toolpath.beads[0], 1, 0, 0.2);
}

TEST(Machine, G92AfterwardsMovesTheFrame) {
    // The same lines again, 30 mm to the right.
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\nG1 X10 E1\nG1 X30 Y0\nG92 X0\nG1 X10 E1\nG92.1\nG1 X10 Y1 E1\nG92 X0\nG28 X\nG1 X2 E1\n");
    expectStart(toolpath.beads[1], 30, 0, 0.2);
    expectEnd(toolpath.beads[1], 40, 0, 0.2);
    expectEnd(toolpath.beads[2], 10, 1, 0.2);
    expectStart(toolpath.beads[3], 0, 1, 0.2);
    expectEnd(toolpath.beads[3], 2, 1, 0.2);
}

TEST(Machine, BareG92ZeroesEverything) {
    const Toolpath toolpath = readProgram("M82\nG1 X5 Y6 Z7\nG1 E3\nG92\nG1 Z.2\nG1 X50 E1\n");
    expectStart(toolpath.beads[0], 0, 0, 0.2);
    EXPECT_DOUBLE_EQ(toolpath.filament_mm, 1);
}

TEST(Machine, G28) {
    const Toolpath all = readProgram("M83\nG1 X5 Y6 Z7\nG28 W\nG1 X1 E1\nG1 X2 Y2 Z.4\nG28 Y0\nG1 X3 E1\n");
    expectStart(all.beads[0], 0, 0, 0);
    expectStart(all.beads[1], 2, 0, 0.4);
}

TEST(Machine, Inches) {
    const Toolpath toolpath = readProgram("M83\nG20\nG1 Z.01 F60\nG1 X1 E.1\nG21\nG1 X30 E1\n");
    expectEnd(toolpath.beads[0], 25.4, 0, 0.254);
    expectEnd(toolpath.beads[1], 30, 0, 0.254);
    EXPECT_NEAR(toolpath.filament_mm, 2.54 + 1, 1e-12);
    EXPECT_FLOAT_EQ(toolpath.runs[0].speed, 25.4F);
}

TEST(Machine, InchArcs) {
    const Toolpath toolpath = readProgram("M83\nG20\nG1 Z.01\nG3 X0 Y2 J1 E.1\n");
    ASSERT_EQ(toolpath.arcs.size(), 1U);
    EXPECT_NEAR(toolpath.arcs[0].center_y, 25.4, 1e-12);
}

TEST(Machine, Volumetric) {
    const Toolpath toolpath = readProgram("M83\nM200 D1.75\nG1 Z.2\nG1 X9 E3\nM200 D0\nG1 X0 E3\n");
    EXPECT_NEAR(toolpath.extruded_mm3, 3 + 3 * kFilamentArea, 1e-12);
    EXPECT_NEAR(toolpath.filament_mm, 3 / kFilamentArea + 3, 1e-12);
    EXPECT_NEAR(volumeOf(toolpath, toolpath.beads[0]), 3, 1e-5);
    EXPECT_NEAR(readProgram("M83\nM200 S1 D3\nM200 S0\nM200\nG1 Z.2\nG1 X9 E1\n").filament_mm, 1, 1e-12);
}

TEST(Machine, VolumetricBySettings) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nG1 X9 E3\n; use_volumetric_e = 1\n; filament_diameter = 3\n");
    EXPECT_NEAR(toolpath.extruded_mm3, 3, 1e-12);
    EXPECT_NEAR(toolpath.filament_mm, 3 / (std::numbers::pi / 4 * 9), 1e-12);
    EXPECT_DOUBLE_EQ(toolpath.filament_diameter, 3);
}

TEST(Machine, TheLostLineEndAfterM200) {
    // A start script whose line end was written as the letter n: M200 and G28 both hold.
    const Toolpath toolpath = readProgram("M83\nG1 X7\nM200 D1.75nG28\nG1 Z.2\nG1 X9 E3\n");
    expectStart(toolpath.beads[0], 0, 0, 0.2);
    EXPECT_NEAR(toolpath.extruded_mm3, 3, 1e-12);
}

TEST(Machine, FilamentDiameter) {
    const std::string program = "M83\nG1 Z.2\nG1 X9 E1\nT1\nG1 X0 E1\n; filament_diameter = 1.75,3\n";
    EXPECT_NEAR(readProgram(program).extruded_mm3, std::numbers::pi / 4 * (1.75 * 1.75 + 9), 1e-12);
    ReadOptions options;
    options.filament_diameters = {2};
    EXPECT_NEAR(readProgram(program, options).extruded_mm3, 2 * std::numbers::pi, 1e-12);
}

TEST(Machine, FlowScalesVolumeNotFilament) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nM221 S50\nG1 X9 E2\nM221 T1 S200\nG1 X0 E2\nT1\nG1 X9 E2\n");
    EXPECT_DOUBLE_EQ(toolpath.filament_mm, 6);
    EXPECT_NEAR(toolpath.extruded_mm3, (1 + 1 + 4) * kFilamentArea, 1e-12);
    EXPECT_NEAR(beadVolume(toolpath), toolpath.extruded_mm3, 1e-5);
}

TEST(Machine, FirmwareRetractionIsNoBead) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nG1 X9 E2\nG10\nG0 X0\nG11\nG10 P1 S0 R0\nG1 X9 E2\n");
    EXPECT_EQ(toolpath.beads.size(), 2U);
    EXPECT_TRUE(toolpath.warnings.empty());
}

TEST(Machine, ArcsStayArcs) {
    const Toolpath toolpath = readProgram("M83\nG1 X1 Z.2\nG3 X0 Y1 I-1 J0 E.1\nG2 X1 Y0 R1 E.1\nG2 X1 Y0 I-1 E.1\n");
    ASSERT_EQ(toolpath.arcs.size(), 3U);
    EXPECT_NEAR(toolpath.arcs[0].sweep, std::numbers::pi / 2, 1e-12);
    EXPECT_NEAR(toolpath.arcs[1].sweep, -std::numbers::pi / 2, 1e-12);
    EXPECT_NEAR(toolpath.arcs[1].center_x, 0 + 1 - 1, 1e-12);
    EXPECT_NEAR(toolpath.arcs[2].sweep, -2 * std::numbers::pi, 1e-12);
    for (std::int32_t i = 0; i < 3; ++i) EXPECT_EQ(toolpath.beads[static_cast<std::size_t>(i)].arc, i);
    EXPECT_NEAR(beadVolume(toolpath), 0.3 * kFilamentArea, 1e-5);
}

TEST(Machine, ArcEndsInRelativeMode) {
    const Toolpath toolpath = readProgram("M83\nG1 X10 Y10 Z.2\nG91\nM83\nG3 X-1 Y1 I-1 E1\n");
    expectEnd(toolpath.beads[0], 9, 11, 0.2);
    EXPECT_NEAR(toolpath.arcs[0].center_x, 9, 1e-12);
    EXPECT_NEAR(toolpath.arcs[0].sweep, std::numbers::pi / 2, 1e-12);
}

TEST(Machine, Helix) {
    const Toolpath toolpath = readProgram("; layer_height = 0.2\nM83\nG1 X3 Z.2\nG3 X3 Y0 Z4.2 I-3 E5\n");
    ASSERT_EQ(toolpath.beads.size(), 1U);
    EXPECT_NEAR(beadLength(toolpath, toolpath.beads[0]), std::hypot(6 * std::numbers::pi, 4), 1e-9);
    EXPECT_NEAR(beadVolume(toolpath), 5 * kFilamentArea, 1e-5);
    EXPECT_FLOAT_EQ(toolpath.runs[0].height, 0.2F);
}

TEST(Machine, BrokenArcsAreStraightWithAWarning) {
    const Toolpath toolpath = readProgram("M83\nG1 X1 Z.2\nG3 X0 Y3 I-1 E1\nG2 X9 Y9 E1\nG2 X20 Y9 R1 E1\n");
    EXPECT_EQ(toolpath.beads.size(), 3U);
    EXPECT_TRUE(toolpath.arcs.empty());
    EXPECT_EQ(warningCount(toolpath, "arc"), 3U);
}

TEST(Machine, LinesWithoutACommandGoOn) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nX5 E1\nY5 E1\nF900\n");
    ASSERT_EQ(toolpath.beads.size(), 2U);
    expectEnd(toolpath.beads[1], 5, 5, 0.2);
}

TEST(Machine, SeveralCommandsInALine) {
    const Toolpath toolpath = readProgram("G21 G90 M83\nG1 Z.2\nG53 G1 X5 E1\n");
    EXPECT_EQ(toolpath.beads.size(), 1U);
    EXPECT_DOUBLE_EQ(toolpath.filament_mm, 1);
}

TEST(Machine, Tools) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nT3\nG1 X50 E1\nT-1\nT255\nT1000\nTx\nT?\nG1 X99 E1\n");
    EXPECT_EQ(toolpath.runs.size(), 1U);
    EXPECT_EQ(toolpath.runs[0].tool, 3);
    EXPECT_TRUE(toolpath.warnings.empty());
}

TEST(Machine, FetchingUnloadedFilamentIsNoExtrusion) {
    // A multi-material unit: out by 80 mm, back by 80 mm while travelling, then 3 mm of bead.
    const std::string program =
        "M83\nG1 Z.2\nG1 X5 E1\nG1 E-80\nT1\nG1 E20\nG1 X50 E58\nG1 X0 E5\n; single_extruder_multi_material = 1\n";
    const Toolpath toolpath = readProgram(program);
    ASSERT_EQ(toolpath.beads.size(), 2U);
    EXPECT_NEAR(toolpath.filament_mm, 1 + 3, 1e-9);
    // Retractions of more than 10 mm are taken back by macros: what the file pushes on a path is laid there.
    EXPECT_NEAR(readProgram("M83\nG1 Z.2\nG1 E-16\nG1 X50 E5\nG1 E-16\nG1 X0 E5\n").filament_mm, 10, 1e-9);
}

TEST(Machine, UnknownCommandsAreRemarkedOnceEach) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nM98765\nM98765\nG777\nMY_MACRO A=1\nM104 S200\nG1 X50 E1\n");
    EXPECT_EQ(warningCount(toolpath, "M98765"), 2U);
    EXPECT_EQ(warningCount(toolpath, "G777"), 1U);
    EXPECT_EQ(warningCount(toolpath, "MY_MACRO"), 1U);
    EXPECT_EQ(toolpath.warnings.size(), 3U);
}

TEST(Machine, RawTextMovesNothing) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nM117 G1 X50 E9\nG1 X1 E1\n");
    EXPECT_EQ(toolpath.beads.size(), 1U);
    expectStart(toolpath.beads[0], 0, 0, 0.2);
}

struct BadCase {
    std::string_view program;
    std::string_view message;
};

class MachineRefuses : public testing::TestWithParam<BadCase> {};

TEST_P(MachineRefuses, WithThePlace) {
    const std::string message = inputErrorOf(GetParam().program);
    EXPECT_TRUE(message.starts_with("test.gcode:2: ")) << message;
    EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Table, MachineRefuses,
    testing::Values(BadCase{"M83\nG1 X1000000000 E1\n", "X1000000000"}, BadCase{"M83\nG1 Y-100001 E1\n", "Y-100001"},
                    BadCase{"M83\nG1 X1 E1000000000\n", "E1000000000"},
                    BadCase{"M83\nG2 X1 Y1 J1000000 E1\n", "J1000000"}, BadCase{"M83\nG92 X1000000\n", "X1000000"},
                    BadCase{"M83\nM200 D500\n", "M200 D500"}, BadCase{"M83\nM221 S-5\n", "M221 S-5"},
                    BadCase{"G20\nG1 X9000 E1\n", "X9000"}));

TEST(Machine, NamesOfFirmwares) {
    EXPECT_EQ(firmwareName(Firmware::klipper), "klipper");
    EXPECT_EQ(firmwareName(Firmware::automatic), "automatic");
}

// PrusaSlicer from 2.8 on names all objects first; Marlin's and RepRapFirmware's numbers alone are names as well.
TEST(Machine, ObjectsAreCalledByTheNumberThatTheirNameWasGiven) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\nM486 S0\nM486 Alid\nM486 S-1\nM486 S3\nM486 Alid\nM486 S-1\nM486 S3\nG1 X10 E1\nM486 S0\nG1 X20 "
        "E1\nM486 S7\nG1 X30 E1\nM486 S-1\nG1 X40 E1\n");
    ASSERT_EQ(toolpath.beads.size(), 4U);
    const auto object = [&](std::size_t bead) { return toolpath.objects[toolpath.runOf(toolpath.beads[bead]).object]; };
    EXPECT_EQ(object(0), "lid 3");  // two copies of one name stay apart
    EXPECT_EQ(object(1), "lid");
    EXPECT_EQ(object(2), "object 7");
    EXPECT_EQ(object(3), "");
}

TEST(Machine, ChangesOfToolByOtherNames) {
    for (const auto* change : {"M108 T1", "M135 T1", "M1020 S1", "SELECT_TOOL T=1", "MMU_CHANGE_TOOL TOOL=1"}) {
        const Toolpath toolpath = readProgram(std::string("M83\nG1 Z.2\nG1 X9 E1\n") + change + "\nG1 X0 E1\n");
        EXPECT_EQ(toolpath.runOf(toolpath.beads[1]).tool, 1) << change;
        EXPECT_TRUE(toolpath.warnings.empty()) << change;
    }
    for (const auto* other : {"M108", "M108 S5", "M135 S2", "M1020 S255", "M108 T-1", "SELECT_TOOL"}) {
        const Toolpath toolpath = readProgram(std::string("M83\nG1 Z.2\nG1 X9 E1\n") + other + "\nG1 X0 E1\n");
        EXPECT_EQ(toolpath.runOf(toolpath.beads[1]).tool, 0) << other;
    }
}

TEST(Machine, ALoadedFilamentIsAtTheNozzle) {
    // 90 mm were drawn back, and 50 mm bring the next filament: the slicer says that it is there.
    const Toolpath toolpath =
        readProgram("M83\nG1 Z.2\nG1 X9 E1\nG1 E-90\nT1\nG1 E50\n; CP TOOLCHANGE WIPE\nG1 X60 E3\nG1 X0 E3\n");
    EXPECT_NEAR(toolpath.filament_mm, 7, 1e-9);
}

TEST(Machine, StrutsAndPrimes) {
    const auto beads = [](std::string_view moves) {
        return readProgram("M83\n; layer_height = 0.2\nG1 Z.2\nG1 X9 E1\n" + std::string(moves)).beads.size();
    };
    EXPECT_EQ(beads("G1 Z3 E.1\n"), 2U);
    EXPECT_EQ(beads("G1 E-2\nG1 Z.4 E2\nG1 X0 E1\n"), 2U);   // takes back what was drawn back
    EXPECT_EQ(beads("G1 E-2\nG1 Z4 E2.2\nG1 X0 E1\n"), 3U);  // and lays a thread of the rest
    EXPECT_EQ(beads("G1 Z.1 E1\n"), 1U);                     // downwards there is no room
    EXPECT_EQ(beads("G1 Z1 E9\n"), 1U);                      // a blob
    const Toolpath toolpath = readProgram("M83\n; layer_height = 0.2\nG1 Z.2\nG1 X9 E1\nG1 E-1\nG1 Z5.2 E1.3\n");
    EXPECT_NEAR(volumeOf(toolpath, toolpath.beads.back()), 0.3 * kFilamentArea, 1e-5);
}

TEST(Machine, InverseTime) {
    const Toolpath toolpath = readProgram("M83\nG1 Z.2\nG93\nG1 X10 F6 E1\nG94\nG1 X0 F1200 E1\n");
    EXPECT_NEAR(static_cast<double>(toolpath.runOf(toolpath.beads[0]).speed), 1, 1e-6);  // 10 mm in a sixth of a minute
    EXPECT_NEAR(static_cast<double>(toolpath.runOf(toolpath.beads[1]).speed), 20, 1e-6);
    // Of an arc the time is of its path, also where it ends at its start: 10 pi and 20 pi mm in 10 s.
    const Toolpath arcs = readProgram("M83\nG1 X10 Y0 Z.2 F600\nG93\nG3 X-10 I-10 J0 E1 F6\nG3 I10 J0 E1 F6\n");
    EXPECT_NEAR(static_cast<double>(arcs.runOf(arcs.beads[0]).speed), std::numbers::pi, 1e-6);
    EXPECT_NEAR(static_cast<double>(arcs.runOf(arcs.beads[1]).speed), 2 * std::numbers::pi, 1e-6);
}

// Marlin's M503 reports "M200 S0 D1.75" where E is in mm. Each tool has a filament of its own.
TEST(Machine, VolumetricIsWhatM200SSays) {
    const auto volume = [](const std::string& m200) {
        const Toolpath toolpath = readProgram(m200 + "\nM83\nG1 X0 Y0 Z.2\nG1 X20 E1\n");
        return volumeOf(toolpath, toolpath.beads[0]);
    };
    EXPECT_NEAR(volume("M200 S0 D1.75"), kFilamentArea, 1e-5);
    EXPECT_NEAR(volume("M200 S1 D1.75"), 1, 1e-6);
    EXPECT_NEAR(volume("M200 D1.75"), 1, 1e-6);
    EXPECT_NEAR(volume("M200 D1.75\nM200 D0"), kFilamentArea, 1e-5);
    EXPECT_NEAR(volume("M200 S1 D0"), kFilamentArea, 1e-5);
    const Toolpath two = readProgram("M200 T0 D1.75\nM200 T1 D2.85\nM83\nG1 X0 Y0 Z.2\nG1 X20 E2\nT1\nG1 X0 E2\n");
    EXPECT_NEAR(two.filament_mm, 2 / kFilamentArea + 2 / (std::numbers::pi / 4 * 2.85 * 2.85), 1e-9);
}

}  // namespace
}  // namespace stratum::gcode

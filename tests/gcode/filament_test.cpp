#include "gcode/filament.h"

#include "base/input_file.h"
#include "corpus.h"
#include "gcode/program.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

namespace stratum::gcode {
namespace {

const std::string kGriffin = ";FLAVOR:Griffin\n;EXTRUDER_TRAIN.0.MATERIAL.VOLUME_USED:";

TEST(Filament, AGriffinFilesVolumeTellsItsFilament) {
    // 10 mm of 2.85 mm filament are 63.79 mm^3; the slicer writes whole numbers.
    const Toolpath toolpath = readProgram(kGriffin + "64\nM83\nG1 Z.2\nG1 X99 E10\n");
    EXPECT_DOUBLE_EQ(toolpath.filament_diameter, 2.85);
    EXPECT_NEAR(beadVolume(toolpath), 10 * std::numbers::pi / 4 * 2.85 * 2.85, 1e-4);
    EXPECT_NEAR(toolpath.extruded_mm3, beadVolume(toolpath), 1e-4);
    EXPECT_NEAR(toolpath.footer_mm, 10, 0.05);
    EXPECT_EQ(warningCount(toolpath, "2.85 mm filament, which is taken"), 1U);
}

TEST(Filament, ADiameterThatIsKnownStays) {
    const std::string program = "64\nM83\nG1 Z.2\nG1 X99 E10\n";
    ReadOptions options;
    options.filament_diameters = {1.75};
    EXPECT_DOUBLE_EQ(readProgram(kGriffin + program, options).filament_diameter, 1.75);
    EXPECT_DOUBLE_EQ(readProgram(kGriffin + program + "; filament_diameter = 2\n").filament_diameter, 2);
    EXPECT_DOUBLE_EQ(readProgram(kGriffin + "24\nM83\nG1 Z.2\nG1 X99 E10\n").filament_diameter, 1.75);
}

TEST(Filament, TheCorpusUfpCountsVolume) {
    // Its FLAVOR is Marlin(Volumetric); there is no M200.
    STRATUM_NEEDS_CORPUS(path, "gcode/gcode_metadata-cura_2ext.ufp");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "ufp");
    const double area = std::numbers::pi / 4 * toolpath.filament_diameter * toolpath.filament_diameter;
    EXPECT_NEAR(toolpath.extruded_mm3, 1446.35, 1e-3 * 1446.35);
    ASSERT_EQ(toolpath.filament_by_tool.size(), 2U);
    EXPECT_NEAR(toolpath.filament_by_tool[0] * area, 772.133, 1e-3 * 772.133);
    EXPECT_NEAR(toolpath.filament_by_tool[1] * area, 674.215, 1e-3 * 674.215);
    EXPECT_NEAR(toolpath.footer_mm, toolpath.filament_mm, 1e-3 * toolpath.filament_mm);
    EXPECT_EQ(toolpath.extrusion_rule, "mm^3 (the file's FLAVOR is Marlin(Volumetric))");
}

TEST(Filament, TheCorpusGriffinFileCountsLength) {
    STRATUM_NEEDS_CORPUS(path, "gcode/RepRapFirmware-SD-benchy_pathio.gcode");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "pathio");
    EXPECT_NEAR(toolpath.extruded_mm3, 12034, 12);  // its header
    EXPECT_DOUBLE_EQ(toolpath.filament_diameter, 1.75);
}

// A wall of `lines` lines of 10 mm, 0.2 mm high, each of `e` mm of filament.
std::string wall(int lines, double e) {
    std::string program = ";Layer height: 0.2\nM83\nG1 Z.2\n";
    for (int i = 0; i < lines; ++i)
        program += "G1 X" + std::to_string(10 * ((i + 1) % 2)) + " E" + std::to_string(e) + "\n";
    return program;
}

TEST(Filament, TheWidthOfLinesTellsTheirFilament) {
    constexpr double kThick = 0.4 * 0.2 * 10 / (std::numbers::pi / 4 * 2.85 * 2.85);  // 0.4 mm wide of 2.85 mm
    constexpr double kThin = 0.4 * 0.2 * 10 / kFilamentArea;
    const Toolpath thick = readProgram(wall(200, kThick));
    EXPECT_DOUBLE_EQ(thick.filament_diameter, 2.85);
    EXPECT_NEAR(beadVolume(thick), 200 * 0.4 * 0.2 * 10, 0.1);
    EXPECT_EQ(warningCount(thick, "which is taken (--filament-diameter 1.75 if not)"), 1U);
    EXPECT_NE(thick.extrusion_rule.find("2.85 mm (the width of its lines)"), std::string::npos);
    const Toolpath thin = readProgram(wall(200, kThin));
    EXPECT_DOUBLE_EQ(thin.filament_diameter, 1.75);
    EXPECT_EQ(warningCount(thin, "thick its filament"), 0U);
    // Between the two, and where there is little to tell by.
    EXPECT_EQ(warningCount(readProgram(wall(200, 0.65 * kThin)), "if it is 2.85 mm, say so"), 1U);
    EXPECT_EQ(warningCount(readProgram(wall(6, kThick)), "if it is 2.85 mm, say so"), 1U);
    EXPECT_EQ(warningCount(readProgram(wall(3, kThick)), "thick its filament"), 0U);
    // A narrow nozzle lays narrow lines; a diameter that is stated stays.
    EXPECT_DOUBLE_EQ(readProgram(wall(200, 0.4 * kThin) + "; nozzle_diameter = 0.15\n").filament_diameter, 1.75);
    EXPECT_DOUBLE_EQ(readProgram(wall(200, kThick) + "; filament_diameter = 1.75\n").filament_diameter, 1.75);
}

// Two tools that lay 200 mm each, the second with the E that `second` mm of filament need for the same bead.
std::string twoTools(double second) {
    const double e = 4 * 1.75 * 1.75 / (second * second);
    return "M83\nG1 Z.2\nG1 X200 E4\nT1\nG1 Y1\nG1 X0 E" + std::to_string(e) + "\n";
}

TEST(Filament, ToolsOfOtherFilamentAreRemarked) {
    EXPECT_EQ(warningCount(readProgram(twoTools(2.85)), "T1 lays 0.377 of the section"), 1U);
    EXPECT_EQ(warningCount(readProgram(twoTools(1.75 * 1.75 / 2.85)), "e.g. 2.85,1.75"), 1U);
    EXPECT_EQ(warningCount(readProgram(twoTools(1.75)), "of the section"), 0U);
    EXPECT_EQ(warningCount(readProgram(twoTools(2.4)), "of the section"), 0U);
    // The file knows.
    EXPECT_EQ(warningCount(readProgram(twoTools(2.85) + "; filament_diameter = 1.75,1.75\n"), "of the section"), 0U);
}

TEST(Filament, EachToolHasItsOwn) {
    ReadOptions options;
    options.filament_diameters = {1.75, 2.85};
    const Toolpath toolpath = readProgram(twoTools(2.85), options);
    ASSERT_EQ(toolpath.beads.size(), 2U);
    EXPECT_NEAR(toolpath.beads[0].width, toolpath.beads[1].width, 1e-5);
    EXPECT_EQ(warningCount(toolpath, "of the section"), 0U);
}

TEST(Filament, TheCorpusObjectOfFourToolsIsRemarked) {
    // Cura was told 1.75 mm for the first tool only; the others kept its default.
    STRATUM_NEEDS_CORPUS(path, "gcode/filaswitch-mc_testmodel1_Cura.gcode");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "Cura");
    for (const auto* tool : {"T1 lays", "T2 lays", "T3 lays"}) EXPECT_EQ(warningCount(toolpath, tool), 1U) << tool;
}

}  // namespace
}  // namespace stratum::gcode

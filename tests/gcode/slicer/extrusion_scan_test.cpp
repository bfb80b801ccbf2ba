#include "gcode/slicer/extrusion_scan.h"

#include "base/mapped_file.h"
#include "corpus.h"
#include "gcode/program.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

using Drive = ExtrusionScan::Drive;

TEST(ExtrusionScan, Drives) {
    EXPECT_EQ(scanExtrusion("G1 X1 E1\nM101\n").drive, Drive::e_word);
    EXPECT_EQ(scanExtrusion("M101\nG1 X1\nG1 E1\n").drive, Drive::e_word);
    EXPECT_EQ(scanExtrusion("M101\nG1 X1\nM103\n").drive, Drive::switched);
    EXPECT_EQ(scanExtrusion("G1 X1 A1\nM101\n").drive, Drive::axes_ab);
    EXPECT_EQ(scanExtrusion("G1 X1 B1\n").drive, Drive::axes_ab);
    EXPECT_EQ(scanExtrusion("G92 A0\nG1 X1\n").drive, Drive::e_word);
    EXPECT_EQ(scanExtrusion("").drive, Drive::e_word);
}

std::string moves(int count, bool relative) {
    std::string program;
    for (int i = 1; i <= count; ++i)
        program += "G1 X" + std::to_string(i) + " E" + (relative ? (i % 2 ? ".2" : ".3") : std::to_string(i)) + "\n";
    return program;
}

TEST(ExtrusionScan, FallingBack) {
    EXPECT_TRUE(scanExtrusion(moves(20, true)).falls_back);
    EXPECT_FALSE(scanExtrusion(moves(20, false)).falls_back);
    EXPECT_FALSE(scanExtrusion(moves(8, true)).falls_back);  // too few to tell
    EXPECT_FALSE(scanExtrusion("M82\n" + moves(20, true)).falls_back);
    EXPECT_FALSE(scanExtrusion("M83\n" + moves(20, true)).falls_back);
}

TEST(ExtrusionScan, ResetsAndRetractionsAreNoFalls) {
    std::string program;
    for (int i = 0; i < 20; ++i) program += moves(3, false) + "G1 E1\nG92 E0\n";
    EXPECT_FALSE(scanExtrusion(program).falls_back);
}

TEST(ExtrusionScan, BehindAG90ThatCameAfterM83) {
    EXPECT_TRUE(fallsBackAfterG90("M83\nG90\n" + moves(20, true)));
    EXPECT_TRUE(fallsBackAfterG90("G90\nM82\nM83\n G90 G21\n" + moves(20, true)));
    EXPECT_TRUE(fallsBackAfterG90("M83\n" + moves(3, true) + "G91\nG90\n" + moves(20, true)));
    EXPECT_FALSE(fallsBackAfterG90("M83\nG90\n" + moves(20, false)));
    EXPECT_FALSE(fallsBackAfterG90("M83\nG90\n" + moves(8, true)));  // too few to tell
    EXPECT_FALSE(fallsBackAfterG90("M83\nG90\nM82\n" + moves(20, true)));
    EXPECT_FALSE(fallsBackAfterG90("M82\nG90\n" + moves(20, true)));
    EXPECT_FALSE(fallsBackAfterG90("; M83\nG90\n" + moves(20, true)));
    EXPECT_FALSE(fallsBackAfterG90("M83\nG90.1\n" + moves(20, true)));
    EXPECT_FALSE(fallsBackAfterG90("M83\nM82\nG90\n" + moves(20, true) + "M83\n"));
    EXPECT_FALSE(fallsBackAfterG90(""));
}

TEST(ExtrusionScan, AFileWithoutSettingsThatCountsOnMarlin1) {
    // Simplify3D's M83 comes before its G90; with the comments gone, nothing but the numbers says that it holds.
    STRATUM_NEEDS_CORPUS(path, "gcode/filaswitch-mc_testmodel1_S3D.gcode");
    const MappedFile file(path);
    const Toolpath whole = readToolpath(file.bytes(), "whole");
    std::string bare;
    bool comment = false;
    for (const char c : file.bytes()) {
        if (c == ';') comment = true;
        if (c == '\n') comment = false;
        if (!comment) bare += c;
    }
    const Toolpath toolpath = readToolpath(bare, "bare");
    EXPECT_EQ(toolpath.beads.size(), whole.beads.size());
    EXPECT_NEAR(toolpath.filament_mm, whole.filament_mm, 1e-6);
    EXPECT_GT(warningCount(toolpath, "G90 makes E absolute again"), 0U);
    EXPECT_EQ(warningCount(whole, "G90 makes E absolute again"), 0U);
}

}  // namespace
}  // namespace stratum::gcode

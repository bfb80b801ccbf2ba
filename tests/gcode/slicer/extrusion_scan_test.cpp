#include "gcode/slicer/extrusion_scan.h"

#include "base/input_file.h"
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
    const InputFile file(path);
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

TEST(ExtrusionScan, EqualNumbersAreIncrements) {
    std::string equal;
    for (int i = 0; i < 20; ++i) equal += "G1 X" + std::to_string(i) + " E.7\n";
    EXPECT_TRUE(scanExtrusion(equal).falls_back);
    EXPECT_TRUE(fallsBackAfterG90("M83\nG90\n" + equal));
    // Absolute E that is repeated on every travel move.
    std::string repeated;
    for (int i = 0; i < 40; ++i) repeated += "G1 X" + std::to_string(i) + " E" + std::to_string(i / 4) + "\n";
    EXPECT_FALSE(scanExtrusion(repeated).falls_back);
    EXPECT_FALSE(fallsBackAfterG90("M83\nG90\n" + repeated));
}

TEST(ExtrusionScan, APartOfAProgramThatCountsEFromBefore) {
    const std::string lines = "G1 X20 E723.9\nG1 Y20 E724.2\nG1 X10 E724.5\nG1 Y10 E724.8\n";
    EXPECT_TRUE(scanExtrusion("M82\nG92 E0\nG1 X10 Y10 E723.6\n" + lines).cut);
    EXPECT_TRUE(scanExtrusion("G1 X10 Y10 E723.6\n" + lines).cut);
    EXPECT_FALSE(scanExtrusion("M82\nG1 X10 Y10 E0.6\n" + lines).cut);
    // Large beads: each line holds as much.
    EXPECT_FALSE(scanExtrusion("M82\nG1 X1000 E3000\nG1 Y1000 E6000\nG1 X0 E9000\nG1 Y0 E12000\n").cut);

    // A purge on the spot.
    EXPECT_FALSE(
        scanExtrusion("M82\nG92 E0\nG1 X10 Y10 E300\nG92 E0\nG1 X20 E.3\nG1 Y20 E.6\nG1 X10 E.9\nG1 Y10 E1\n").cut);

    const Toolpath part = readProgram("M82\nG92 E0\nG1 X10 Y10 Z0.2 E723.6\n" + lines);
    EXPECT_EQ(warningCount(part, "the first E is 723.6"), 1U);
    ASSERT_EQ(part.beads.size(), 4U);
    EXPECT_NEAR(volumeOf(part, part.beads[0]), 0.3 * kFilamentArea, 1e-3);
    // It says where it counts from.
    EXPECT_EQ(readProgram("M82\nG92 E723.3\nG1 X10 Y10 Z0.2 E723.6\n" + lines).beads.size(), 5U);
}

TEST(ExtrusionScan, BeforeALateMode) {
    const ExtrusionScan rising = scanExtrusion("G92 E0\nG1 X1 E5\nG1 X9 E9\nM83\n" + moves(20, true));
    EXPECT_TRUE(rising.mode_follows);
    EXPECT_FALSE(rising.repeats);
    EXPECT_TRUE(scanExtrusion("G1 X1 E5\nG1 X9 E5\nM82\n").repeats);
    EXPECT_FALSE(scanExtrusion(moves(20, true)).mode_follows);
    // A machine that was just switched on counts absolutely, whatever the slicer's settings say of the rest.
    const std::string program =
        "G92 E0\nG1 X1 Z.2 E2\nG1 X9 E5\nG92 E0\nM83\nG1 X20 E1\n; use_relative_e_distances = 1\n";
    EXPECT_NEAR(readProgram(program).filament_mm, 6, 1e-9);
    // A retraction in place and back, in absolute numbers.
    EXPECT_FALSE(scanExtrusion("G1 E25\nG1 E23\nG1 E25\nG1 X1 E25\nG1 X9 E25\nM83\n").repeats);
    const Toolpath repeats = readProgram("G1 X1 Z.2 E5\nG1 X9 E5\nM83\nG1 X20 E1\n");
    EXPECT_NEAR(repeats.filament_mm, 11, 1e-9);
    EXPECT_EQ(warningCount(repeats, "the first M82 or M83 comes late"), 1U);
}

TEST(ExtrusionScan, TimeGrowsWithTheText) {
    // Each of these took minutes when the text was searched anew for every pair or every hit.
    std::string pairs;
    for (int i = 0; i < 100000; ++i) pairs += "M83\nM82\nG1 X1 F" + std::to_string(i) + "\n";
    EXPECT_FALSE(fallsBackAfterG90(pairs + std::string(4 << 20, '\n') + "G90\n"));
    std::string comment = ";";
    for (int i = 0; i < 1000000; ++i) comment += "M83";
    EXPECT_FALSE(fallsBackAfterG90(comment + "\nG90\n" + moves(20, true)));
    std::string line = "G1 X1 ";
    for (int i = 0; i < 300000; ++i) line += "M83M82";
    EXPECT_FALSE(fallsBackAfterG90(line + "\nG90\n" + moves(20, true)));
}

}  // namespace
}  // namespace stratum::gcode

#include "gcode/extrusion_scan.h"

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

}  // namespace
}  // namespace stratum::gcode

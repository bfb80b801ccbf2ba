#include "gcode/slicer/truncation.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

TEST(Truncation, OfUnknownSlicersTheLastLineTells) {
    EXPECT_EQ(findCut("G1 X1\nG1 X2 E3", ""), "the last line has no end");
    for (const auto* whole : {"", "G1 X1\n", "G1 X1\r", "G1 X1\nM84 ; disable steppers", "G1 X1\n; done"})
        EXPECT_EQ(findCut(whole, ""), "") << whole;
}

TEST(Truncation, AWordThatBreaksOff) {
    for (const auto* cut : {"G1 X1\nG", "G1 X1\nM", "G1 X1\nT", "G1 X1\nM104 S", "G1 X1\nM204 P800 T"})
        EXPECT_EQ(findCut(cut, ""), "the last line breaks off amid a word") << cut;
    for (const auto* whole : {"G1 X1\nM84 X Y E", "G1 X1\nG28 X", "G1 X1\nM104 S0", "G1 X1\nEND_PRINT", "G1 X1\n;S",
                              "G1 X1\nM117 DONE ; S", "G1 X1\nM104 S\n"})
        EXPECT_EQ(findCut(whole, ""), "") << whole;
}

TEST(Truncation, OfKnownOnesTheTrailer) {
    EXPECT_NE(findCut("G1 X1\n", "PrusaSlicer 2.5.0").find("what PrusaSlicer writes"), std::string::npos);
    EXPECT_EQ(findCut("G1 X1\n; filament used [mm] = 1\n", "PrusaSlicer 2.5.0"), "");
    EXPECT_NE(findCut("; filament used [mm] = 1\nG1 X1\n", "PrusaSlicer 2.6.0"), "");  // in its header
    EXPECT_NE(findCut("G1 X1\n", "Cura_SteamEngine 4.13.0"), "");
    EXPECT_EQ(findCut("G1 X1\n;End of Gcode\n", "Cura_SteamEngine 4.13.0"), "");
    EXPECT_EQ(findCut("G1 X1\nM84 ; Turn steppers off\n", "Cura_SteamEngine 15.01"), "");  // it wrote nothing there
    // With the settings in front, as Orca for FlashForge writes them.
    EXPECT_EQ(findCut("; CONFIG_BLOCK_END\nG1 X1\nM73 P100 R0\n", "OrcaSlicer 2.3.0"), "");
    EXPECT_NE(findCut("; CONFIG_BLOCK_END\nM73 P99 R0\nG1 X1\n", "OrcaSlicer 2.3.0"), "");
    EXPECT_NE(findCut(";Print Time? none\n", "ideaMaker 4.2"), "");
    EXPECT_EQ(findCut("; --- filament used: 3 mm ---", "Kiri:Moto 3.0"), "");
}

}  // namespace
}  // namespace stratum::gcode

#include "gcode/slicer/bead_colors.h"

#include "base/mapped_file.h"
#include "corpus.h"
#include "gcode/program.h"

#include <gtest/gtest.h>

#include <array>
#include <numeric>

namespace stratum::gcode {
namespace {

using Colors = std::vector<std::optional<Rgb>>;

Colors toolColors(const std::string& settings) {
    return readProgram("M83\nG1 Z.2\nG1 X10 E1\n" + settings).tool_colors;
}

Colors allColors(const Toolpath& toolpath) {
    std::vector<std::uint32_t> all(toolpath.beads.size());
    std::iota(all.begin(), all.end(), 0U);
    return distinctColors(toolpath, all);
}

TEST(BeadColors, TheFilamentsColorGoesBeforeTheExtruders) {
    const Colors expected{Rgb{0x11, 0x11, 0x11}, Rgb{0x22, 0x22, 0x22}};
    const std::string filament = "; filament_colour = #111111;\"#222222\"\n";
    EXPECT_EQ(toolColors(filament), expected);
    EXPECT_EQ(toolColors("; extruder_colour = #FF8000;#0102fe\n" + filament), expected);
    EXPECT_EQ(toolColors(filament + "; extruder_colour = #FF8000;#0102fe\n"), expected);
    EXPECT_EQ(toolColors(filament + "; extruder_colour = \"\";\"\"\n"), expected);
}

TEST(BeadColors, OneExtruderAndThreeFilaments) {
    EXPECT_EQ(toolColors("; extruder_colour = #018001\n; filament_colour = #00AE42;#FF0000;#0000FF\n"),
              (Colors{Rgb{0, 0xae, 0x42}, Rgb{255, 0, 0}, Rgb{0, 0, 255}}));
}

TEST(BeadColors, TheExtrudersColorFillsEmptyPlaces) {
    EXPECT_EQ(toolColors("; filament_colour = #111111;;\n; extruder_colour = #FF8000;#0102FE\n"),
              (Colors{Rgb{0x11, 0x11, 0x11}, Rgb{1, 2, 0xfe}}));
    EXPECT_EQ(toolColors("; filament_colour = #111111\n; extruder_colour = #FF8000;#0102FE\n"),
              (Colors{Rgb{0x11, 0x11, 0x11}, Rgb{1, 2, 0xfe}}));
}

TEST(BeadColors, WhatIsNotStatedIsNotBlack) {
    EXPECT_EQ(toolColors("; filament_colour = ;#000000\n"), (Colors{std::nullopt, Rgb{}}));
    EXPECT_TRUE(toolColors("; extruder_colour = ;\n").empty());
    EXPECT_TRUE(toolColors("").empty());
}

TEST(BeadColors, ByBead) {
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2\nG1 X10 E1\nT1\nG1 X20 E1\nT2\nG1 X30 E1\nT0\n;COLOR_CHANGE,T0,#ED1C24\nM600\nG1 X0 E1\n"
        "; filament_colour = ;#222222\n");
    ASSERT_EQ(toolpath.beads.size(), 4U);
    EXPECT_EQ(colorOf(toolpath, 0), std::nullopt);
    EXPECT_EQ(colorOf(toolpath, 1), (Rgb{0x22, 0x22, 0x22}));
    EXPECT_EQ(colorOf(toolpath, 2), std::nullopt);
    EXPECT_EQ(colorOf(toolpath, 3), (Rgb{0xed, 0x1c, 0x24}));
    EXPECT_EQ(allColors(toolpath), (Colors{std::nullopt, Rgb{0x22, 0x22, 0x22}, Rgb{0xed, 0x1c, 0x24}}));
    const std::array<std::uint32_t, 2> some{3, 1};
    EXPECT_EQ(distinctColors(toolpath, some), (Colors{Rgb{0xed, 0x1c, 0x24}, Rgb{0x22, 0x22, 0x22}}));
    EXPECT_TRUE(distinctColors(toolpath, {}).empty());
    EXPECT_EQ(warningCount(toolpath, "M600"), 0U);
}

TEST(BeadColors, AChangeToAnUnnamedColorIsRemarked) {
    EXPECT_EQ(warningCount(readProgram("M83\nG1 Z.2\nG1 X10 E1\nM600\nG1 X0 E1\n"), "M600 changes"), 1U);
    // PrusaSlicer 2.2 named the tool only.
    EXPECT_EQ(warningCount(readProgram("M83\nG1 Z.2\nG1 X10 E1\n;COLOR_CHANGE,T0\nM600\nG1 X0 E1\n"), "M600 changes"),
              1U);
    EXPECT_EQ(warningCount(readProgram("M600\nM83\nG1 Z.2\nG1 X10 E1\n"), "M600"), 0U);
}

struct CorpusColors {
    const char* file;
    Colors colors;
};

class CorpusBeadColors : public testing::TestWithParam<CorpusColors> {};

TEST_P(CorpusBeadColors, AreTheFilamentsStated) {
    STRATUM_NEEDS_CORPUS(path, std::string("gcode/") + GetParam().file);
    const MappedFile file(path);
    EXPECT_EQ(allColors(readToolpath(file.bytes(), "file")), GetParam().colors);
}

INSTANTIATE_TEST_SUITE_P(
    Files, CorpusBeadColors,
    testing::Values(CorpusColors{"slicer-meta-flashstudio_2color.gcode.3mf", {Rgb{255, 255, 255}, Rgb{0, 0xc1, 0xae}}},
                    CorpusColors{"slicer-meta-orca_twocolors.gcode.3mf", {Rgb{0xc0, 0xc0, 0xc0}}},
                    CorpusColors{"slicercompare-bambu_plate_1.gcode", {Rgb{0, 0xae, 0x42}}},
                    CorpusColors{"preprocess_cancellation-prusaslicer.gcode", {Rgb{0xa7, 0x68, 0xdf}}},
                    CorpusColors{"preprocess_cancellation-cura.gcode", {std::nullopt}}));

}  // namespace
}  // namespace stratum::gcode

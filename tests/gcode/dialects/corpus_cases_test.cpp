// Reduced cases of real files: what is stated in them is read.
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/program.h"
#include "gcode/slicer/bead_colors.h"
#include "gcode/summary.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>
#include <vector>

namespace stratum::gcode {
namespace {

#define STRATUM_READ_CASE(toolpath, name)      \
    STRATUM_NEEDS_CORPUS(path, "cases/" name); \
    const InputFile file(path);                \
    const Toolpath toolpath = readToolpath(file.bytes(), name)

std::vector<Feature> featuresOf(const Toolpath& toolpath) {
    std::vector<Feature> features;
    for (const Bead& bead : toolpath.beads) features.push_back(toolpath.runOf(bead).feature);
    return features;
}

TEST(CorpusCases, ObjectsAreNamedOnce) {
    STRATUM_READ_CASE(toolpath, "01_m486_names_lost.gcode");
    EXPECT_EQ(toolpath.objects, (std::vector<std::string>{"", "cube", "ball"}));
    ASSERT_EQ(toolpath.beads.size(), 2U);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[0]).object, 1);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[1]).object, 2);
}

TEST(CorpusCases, TheExtrudersColorIsTheOneOfPrusaSlicersPreview) {
    STRATUM_READ_CASE(toolpath, "03_mmu_colours.gcode");
    EXPECT_EQ(colorOf(toolpath, 0), (Rgb{0xff, 0x80, 0}));
    EXPECT_EQ(colorOf(toolpath, 1), (Rgb{0xdb, 0x51, 0x82}));
}

TEST(CorpusCases, CrealityPrint) {
    STRATUM_READ_CASE(toolpath, "18_creality_print_4.gcode");
    EXPECT_EQ(toolpath.slicer, "Creality Print V4.3.7.6619");
    EXPECT_EQ(toolpath.stated.printer, "K1 Max");
    EXPECT_EQ(toolpath.stated.materials, (std::vector<std::string>{"PLA"}));
    EXPECT_EQ(toolpath.stated.nozzle_diameters, (std::vector<double>{0.4}));
    EXPECT_EQ(toolpath.stated.layer_height, 0.2);
}

TEST(CorpusCases, TypeNamesOfCanvasAndFiberslice) {
    STRATUM_READ_CASE(toolpath, "21_slicer_type_names.gcode");
    EXPECT_EQ(featuresOf(toolpath), (std::vector<Feature>{Feature::external_perimeter, Feature::perimeter,
                                                          Feature::infill, Feature::bridge, Feature::skirt}));
    EXPECT_EQ(warningCount(toolpath, "unknown feature name"), 0U);
}

TEST(CorpusCases, TheSummaryPutsThePartBesideTheFooter) {
    STRATUM_READ_CASE(toolpath, "24_summary_of_prime.gcode");
    const std::string text = summarize(toolpath);
    EXPECT_NE(text.find("part: 0.80 mm of filament; the file says 0.80 (+0.00 %)\n"), std::string::npos) << text;
    EXPECT_NE(text.find("prime lines before layer 1: 30.00 mm\n"), std::string::npos) << text;
}

TEST(CorpusCases, TwoToolsWithoutColorsAreToldApart) {
    STRATUM_READ_CASE(toolpath, "26_two_tools_no_colours.gcode");
    ASSERT_EQ(toolpath.beads.size(), 2U);
    const StatedColor first = statedColorOf(toolpath, 0);
    const StatedColor second = statedColorOf(toolpath, 1);
    ASSERT_TRUE(first.color && second.color);
    EXPECT_NE(*first.color, *second.color);
    EXPECT_TRUE(first.palette && second.palette);
}

TEST(CorpusCases, ThinLinesAreRemarked) {
    STRATUM_READ_CASE(toolpath, "27_thin_for_their_layers.gcode");
    EXPECT_EQ(warningCount(toolpath, "--filament-diameter 2.85"), 1U);
    EXPECT_EQ(warningCount(toolpath, "lines hold 0.38 of"), 1U);
}

TEST(CorpusCases, CrealityOsIsKlipper) {
    STRATUM_READ_CASE(toolpath, "29_creality_os.gcode");
    EXPECT_EQ(toolpath.firmware, "klipper");
    EXPECT_EQ(toolpath.beads.size(), 12U);
    EXPECT_NEAR(toolpath.filament_mm, 4.8, 1e-9);
}

TEST(CorpusCases, KisslicersDiameter) {
    STRATUM_READ_CASE(toolpath, "30_kisslicer_fiber_dia.gcode");
    EXPECT_DOUBLE_EQ(toolpath.filament_diameter, 3);
    EXPECT_NEAR(beadVolume(toolpath), 113, 0.5);
    EXPECT_NEAR(static_cast<double>(toolpath.beads[0].width), 0.5, 0.06);
    EXPECT_EQ(toolpath.extrusion_rule, "mm of filament of 3 mm (the file's settings)");
}

TEST(CorpusCases, KisslicersOldNames) {
    STRATUM_READ_CASE(toolpath, "31_kisslicer_1_1_0_5_names.gcode");
    EXPECT_EQ(featuresOf(toolpath),
              (std::vector<Feature>{Feature::skirt, Feature::external_perimeter, Feature::infill}));
}

// Real files behind the cases.
struct RealFile {
    const char* file;
    double diameter;            // mm
    const char* warning;        // that must not come
    std::vector<Rgb> colors{};  // of the tools that print, in their order
};

class CorpusCaseFiles : public testing::TestWithParam<RealFile> {};

TEST_P(CorpusCaseFiles, AreReadRight) {
    STRATUM_NEEDS_CORPUS(path, std::string("gcode/") + GetParam().file);
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "file");
    EXPECT_DOUBLE_EQ(toolpath.filament_diameter, GetParam().diameter);
    EXPECT_EQ(warningCount(toolpath, GetParam().warning), 0U);
    std::vector<Rgb> colors;
    for (std::size_t tool = 0; tool < toolpath.filament_by_tool.size(); ++tool)
        if (toolpath.filament_by_tool[tool] > 0 && tool < toolpath.tool_colors.size() && toolpath.tool_colors[tool])
            colors.push_back(*toolpath.tool_colors[tool]);
    EXPECT_EQ(colors, GetParam().colors);
}

INSTANTIATE_TEST_SUITE_P(
    Files, CorpusCaseFiles,
    testing::Values(RealFile{"demestav-thinbox_kisslicer.gcode.gz", 2.85, "unknown feature"},
                    RealFile{"OctoPrint-bp_case_cura15.gcode.gz", 2.85, "filament"},
                    RealFile{"orca2flashforge-test.gcode.gz", 1.75, "cut short", {Rgb{0xc0, 0xc0, 0xc0}}},
                    RealFile{"AnycubicSlicerImageIntractor-multicolor.gcode.gz",
                             1.75,
                             "unknown feature",
                             {Rgb{0xff, 0xec, 0x3d}, Rgb{0xec, 0, 0x8c}}},
                    RealFile{"filaswitch-mc_testmodel1_Cura.gcode",
                             1.75,
                             "M600",
                             {Rgb{0xe6, 0x9f, 0}, Rgb{0, 0x72, 0xb2}, Rgb{0, 0x9e, 0x73}, Rgb{0xd5, 0x5e, 0}}}));

}  // namespace
}  // namespace stratum::gcode

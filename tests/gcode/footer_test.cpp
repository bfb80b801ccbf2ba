#include "gcode/footer.h"

#include "corpus.h"
#include "gcode/program.h"
#include "io/mapped_file.h"

#include <gtest/gtest.h>

#include <numbers>

namespace stratum::gcode {
namespace {

using List = std::vector<double>;

Footer footerOf(std::string_view comment) {
    Footer footer;
    readFooter(comment, footer);
    return footer;
}

TEST(Footer, OfSeveralSlicers) {
    EXPECT_EQ(footerOf("filament used = 290.4mm (0.7cm3)").length, (List{290.4}));
    EXPECT_EQ(footerOf("filament used [mm] = 1.5, 2").length, (List{1.5, 2}));
    EXPECT_EQ(footerOf("Filament used: 0.5m, 0m").length, (List{500, 0}));
    EXPECT_EQ(footerOf("Filament length: 2706.2 mm (2.71 m)").length, (List{2706.2}));
    EXPECT_EQ(footerOf("Material#2 Used: 3.5").length, (List{0, 3.5}));
    EXPECT_EQ(footerOf("--- filament used: 225.03 mm ---").length, (List{225.03}));
}

TEST(Footer, Volumes) {
    EXPECT_EQ(footerOf("Filament used: 772.133mm3, 674.215mm3").volume, (List{772.133, 674.215}));
    EXPECT_TRUE(footerOf("Filament used: 772.133mm3, 674.215mm3").length.empty());
    EXPECT_EQ(footerOf("EXTRUDER_TRAIN.1.MATERIAL.VOLUME_USED:12034").volume, (List{0, 12034}));
}

TEST(Footer, NonsenseIsNotTaken) {
    for (const auto* comment : {"filament used [mm] = much", "Filament used: -1m", "Material#0 Used: 4",
                                "Material# Used: 4", "EXTRUDER_TRAIN.9999.MATERIAL.VOLUME_USED:1",
                                "EXTRUDER_TRAIN.0.NOZZLE.DIAMETER:0.4", "Filament used:", "filament_diameter = 1.75"})
        EXPECT_TRUE(footerOf(comment).empty()) << comment;
}

const std::string kGriffin = ";FLAVOR:Griffin\n;EXTRUDER_TRAIN.0.MATERIAL.VOLUME_USED:";

TEST(Footer, AGriffinFilesVolumeTellsItsFilament) {
    // 10 mm of 2.85 mm filament are 63.79 mm^3; the slicer writes whole numbers.
    const Toolpath toolpath = readProgram(kGriffin + "64\nM83\nG1 Z.2\nG1 X99 E10\n");
    EXPECT_DOUBLE_EQ(toolpath.filament_diameter, 2.85);
    EXPECT_NEAR(beadVolume(toolpath), 10 * std::numbers::pi / 4 * 2.85 * 2.85, 1e-4);
    EXPECT_NEAR(toolpath.extruded_mm3, beadVolume(toolpath), 1e-4);
    EXPECT_NEAR(toolpath.footer_mm, 10, 0.05);
    EXPECT_EQ(warningCount(toolpath, "filament of 2.85 mm is taken"), 1U);
}

TEST(Footer, ADiameterThatIsKnownStays) {
    const std::string program = "64\nM83\nG1 Z.2\nG1 X99 E10\n";
    ReadOptions options;
    options.filament_diameter = 1.75;
    EXPECT_DOUBLE_EQ(readProgram(kGriffin + program, options).filament_diameter, 1.75);
    EXPECT_DOUBLE_EQ(readProgram(kGriffin + program + "; filament_diameter = 2\n").filament_diameter, 2);
    EXPECT_DOUBLE_EQ(readProgram(kGriffin + "24\nM83\nG1 Z.2\nG1 X99 E10\n").filament_diameter, 1.75);
}

TEST(Footer, TheCorpusUfpCountsVolume) {
    // Its FLAVOR is Marlin(Volumetric); there is no M200.
    STRATUM_NEEDS_CORPUS(path, "gcode/gcode_metadata-cura_2ext.ufp");
    const MappedFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "ufp");
    const double area = std::numbers::pi / 4 * toolpath.filament_diameter * toolpath.filament_diameter;
    EXPECT_NEAR(toolpath.extruded_mm3, 1446.35, 1e-3 * 1446.35);
    ASSERT_EQ(toolpath.filament_by_tool.size(), 2U);
    EXPECT_NEAR(toolpath.filament_by_tool[0] * area, 772.133, 1e-3 * 772.133);
    EXPECT_NEAR(toolpath.filament_by_tool[1] * area, 674.215, 1e-3 * 674.215);
    EXPECT_NEAR(toolpath.footer_mm, toolpath.filament_mm, 1e-3 * toolpath.filament_mm);
    EXPECT_EQ(toolpath.extrusion_rule, "mm^3 (the file's FLAVOR is Marlin(Volumetric))");
}

TEST(Footer, TheCorpusGriffinFileCountsLength) {
    STRATUM_NEEDS_CORPUS(path, "gcode/RepRapFirmware-SD-benchy_pathio.gcode");
    const MappedFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "pathio");
    EXPECT_NEAR(toolpath.extruded_mm3, 12034, 12);  // its header
    EXPECT_DOUBLE_EQ(toolpath.filament_diameter, 1.75);
}

}  // namespace
}  // namespace stratum::gcode

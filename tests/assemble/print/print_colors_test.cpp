#include "assemble/print/print_colors.h"

#include "gcode/reader.h"
#include "prints.h"
#include "scratch_folder.h"
#include "shade/map_files.h"
#include "voxelize/beads/selection.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace stratum::assemble {
namespace {

// Two tools, a square each, and what a slicer says of their filaments.
std::string printOf(const std::string& settings) {
    std::string text = "M83\n";
    for (int tool = 0; tool < 2; ++tool)
        text += "T" + std::to_string(tool) + "\nG1 Z0.2 X" + std::to_string(30 * tool) +
                " Y0 F3000\nG91\nG1 X20 E0.7\nG1 Y20 E0.7\nG1 X-20 E0.7\nG1 Y-20 E0.7\nG90\n";
    return text + settings;
}

PrintColors colorsIn(const std::string& settings, std::span<const std::optional<gcode::Rgb>> asked = {}) {
    const gcode::Toolpath toolpath = gcode::readToolpath(printOf(settings), "t");
    return colorsOf(toolpath, voxelize::selectBeads(toolpath, {}), asked);
}

TEST(PrintColors, FinishesFollowFromWordsOfTheFile) {
    const PrintColors colors = colorsIn(
        "; extruder_colour = #ff0000;#0000ff\n; filament_type = PLA;SILK\n"
        "; filament_settings_id = \"Prusament PLA Galaxy Red @MK4\";\"My own\"\n");
    ASSERT_EQ(colors.stated, (std::vector<std::string>{"#ff0000", "#0000ff"}));
    ASSERT_EQ(colors.finishes.size(), 2U);
    EXPECT_TRUE(colors.finishes.at("#ff0000").starts_with("glitter:"));
    EXPECT_TRUE(colors.finishes.at("#0000ff").starts_with("silk:"));
    EXPECT_EQ(colors.report[0]["finish"], "glitter");
    EXPECT_EQ(colors.report[0]["finish_from"], "Prusament PLA Galaxy Red @MK4");
    EXPECT_EQ(colors.report[1]["finish_from"], "SILK");
    EXPECT_TRUE(colorsIn("; extruder_colour = #ff0000;#0000ff\n; filament_type = PLA;PETG\n").finishes.empty());
}

TEST(PrintColors, AskedColorsHaveTheirOwnFinish) {
    const std::array<std::optional<gcode::Rgb>, 1> asked{gcode::Rgb{0, 255, 0}};
    const PrintColors colors = colorsIn("; extruder_colour = #ff0000;#0000ff\n; filament_type = SILK;SILK\n", asked);
    EXPECT_EQ(colors.finishes.size(), 1U);
    EXPECT_TRUE(colors.finishes.contains("#0000ff"));
}

TEST(PrintColors, APictureHasTheFinish) {
    const test::ScratchFolder scratch;
    test::writeText(scratch / "silk.gcode",
                    printOf("; extruder_colour = #ff8000;#ff8000\n; filament_type = PLA Silk;PLA\n"));
    TracingOptions options = test::coarseTracing();
    options.file_colors = true;
    const TracedObjects objects = readTracedObjects({test::objectOf(scratch / "silk.gcode")}, options);
    EXPECT_TRUE(objects.brdf.starts_with("silk:")) << objects.brdf;
}

}  // namespace
}  // namespace stratum::assemble

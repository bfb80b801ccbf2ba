// Reduced files of faults that were found in the world's files; the first line of each says what is right.
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/program.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum::gcode {
namespace {

Toolpath readCase(const std::filesystem::path& path, const ReadOptions& options = {}) {
    const InputFile file(path);
    return readToolpath(file.bytes(), path.filename().string(), options);
}

double filamentOf(const Toolpath& toolpath, std::size_t tool) { return toolpath.filament_by_tool.at(tool); }

void expectQuiet(const Toolpath& toolpath) {
    for (const Warning& warning : toolpath.warnings) ADD_FAILURE() << warning.text;
}

TEST(CorpusMoves, ExtraLoadingMove) {
    STRATUM_NEEDS_CORPUS(path, "cases/02_extra_loading_move.gcode");
    const Toolpath toolpath = readCase(path);
    EXPECT_NEAR(filamentOf(toolpath, 0), 0.4, 1e-9);
    EXPECT_NEAR(filamentOf(toolpath, 1), 27.4, 1e-9);
}

TEST(CorpusMoves, WeedosPictures) {
    STRATUM_NEEDS_CORPUS(path, "cases/04_weedo_w220.gcode");
    const Toolpath toolpath = readCase(path);
    EXPECT_EQ(toolpath.beads.size(), 1U);
    EXPECT_NEAR(toolpath.filament_mm, 0.4, 1e-9);
    expectQuiet(toolpath);
}

TEST(CorpusMoves, CanvasAnnouncesLayersTwice) {
    STRATUM_NEEDS_CORPUS(path, "cases/05_canvas_layers.gcode");
    EXPECT_EQ(readCase(path).layer_count, 2U);
}

TEST(CorpusMoves, AStartProgramBeforeTheSlicersM83) {
    STRATUM_NEEDS_CORPUS(path, "cases/06_start_gcode_before_m83.gcode");
    EXPECT_NEAR(readCase(path).filament_mm, 30.4, 1e-9);
}

TEST(CorpusMoves, AStrutIsPlastic) {
    STRATUM_NEEDS_CORPUS(path, "cases/07_vertical_strut.gcode");
    const Toolpath toolpath = readCase(path);
    ASSERT_EQ(toolpath.beads.size(), 3U);
    EXPECT_EQ(toolpath.beads[1].z0, 0.2);
    EXPECT_EQ(toolpath.beads[1].z1, 5.2);
    EXPECT_NEAR(volumeOf(toolpath, toolpath.beads[1]), 0.2 * kFilamentArea, 1e-5);
    expectQuiet(toolpath);
}

TEST(CorpusMoves, AScarfSeam) {
    STRATUM_NEEDS_CORPUS(path, "cases/08_scarf_seam.gcode");
    const Toolpath toolpath = readCase(path);
    ASSERT_EQ(toolpath.beads.size(), 12U);
    for (const Bead& bead : toolpath.beads) {
        EXPECT_NEAR(static_cast<double>(bead.width), 0.42, 0.002);
        const double below = bead.z0 == 0.2 && bead.z1 == 0.2 ? 0 : 0.2;
        EXPECT_NEAR(static_cast<double>(toolpath.runOf(bead).height), 0.5 * (bead.z0 + bead.z1) - below, 1e-4);
    }
}

TEST(CorpusMoves, DuplicationPrintsACopy) {
    STRATUM_NEEDS_CORPUS(path, "cases/10_idex_duplication.gcode");
    const Toolpath toolpath = readCase(path);
    ASSERT_EQ(toolpath.beads.size(), 2U);
    EXPECT_EQ(toolpath.beads[1].x0, 160);
    EXPECT_EQ(toolpath.beads[1].x1, 170);
    EXPECT_NEAR(toolpath.filament_mm, 0.8, 1e-9);
}

TEST(CorpusMoves, MakerBotsChangesOfTool) {
    STRATUM_NEEDS_CORPUS(path, "cases/11_makerbot_tool_change.gcode");
    const Toolpath toolpath = readCase(path);
    EXPECT_NEAR(filamentOf(toolpath, 0), 0.4, 1e-9);
    EXPECT_NEAR(filamentOf(toolpath, 1), 0.4, 1e-9);
}

TEST(CorpusMoves, EqualIncrements) {
    STRATUM_NEEDS_CORPUS(path, "cases/12_constant_increments.gcode");
    const Toolpath toolpath = readCase(path);
    EXPECT_EQ(toolpath.beads.size(), 12U);
    EXPECT_NEAR(toolpath.filament_mm, 4.8, 1e-9);
    EXPECT_EQ(warningCount(toolpath, "G90 makes E absolute again"), 1U);
}

TEST(CorpusMoves, EqualIncrementsWithoutM83) {
    STRATUM_NEEDS_CORPUS(path, "cases/13_no_m83_constant_increments.gcode");
    const Toolpath toolpath = readCase(path);
    EXPECT_EQ(toolpath.beads.size(), 13U);
    EXPECT_NEAR(toolpath.filament_mm, 5.2, 1e-9);
}

TEST(CorpusMoves, RotaryAxes) {
    STRATUM_NEEDS_CORPUS(path, "cases/14_rotary_axes.gcode");
    EXPECT_THROW(readCase(path), InputError);
    ReadOptions options;
    options.planar = true;
    EXPECT_EQ(warningCount(readCase(path, options), "A and C turn the part or the nozzle"), 1U);
}

TEST(CorpusMoves, WLowersTheTable) {
    STRATUM_NEEDS_CORPUS(path, "cases/15_w_axis.gcode");
    const Toolpath toolpath = readCase(path);
    ASSERT_EQ(toolpath.beads.size(), 3U);
    EXPECT_EQ(toolpath.layer_count, 3U);
    EXPECT_NEAR(toolpath.beads[2].z1, 0.6, 1e-9);
}

TEST(CorpusMoves, ZeroBytesAtTheEnd) {
    STRATUM_NEEDS_CORPUS(path, "cases/16_zero_tail.gcode");
    EXPECT_EQ(readCase(path).beads.size(), 3U);
}

TEST(CorpusMoves, StartCommandsThatPrintNothing) {
    STRATUM_NEEDS_CORPUS(path, "cases/17_known_start_commands.gcode");
    expectQuiet(readCase(path));
}

TEST(CorpusMoves, NestedParentheses) {
    STRATUM_NEEDS_CORPUS(path, "cases/19_nested_parentheses.gcode");
    const Toolpath toolpath = readCase(path);
    ASSERT_EQ(toolpath.beads.size(), 1U);
    EXPECT_EQ(toolpath.beads[0].x1, 10);
    expectQuiet(toolpath);
}

TEST(CorpusMoves, DecimalCommas) {
    STRATUM_NEEDS_CORPUS(path, "cases/20_decimal_commas.gcode");
    EXPECT_GT(warningCount(readCase(path), "decimal commas"), 0U);
}

TEST(CorpusMoves, APrimeLineInAFileWithoutLayerTags) {
    STRATUM_NEEDS_CORPUS(path, "cases/32_prime_without_layer_tags.gcode");
    const Toolpath toolpath = readCase(path);
    ASSERT_EQ(toolpath.beads.size(), 2U);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[0]).layer, 0U);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[1]).layer, 1U);
}

}  // namespace
}  // namespace stratum::gcode

#include "deposit/bead_cutter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::deposit {
namespace {

gcode::Toolpath lineAndArc() {
    gcode::Toolpath toolpath;
    toolpath.runs.push_back({.height = 0.2F, .layer = 1});
    toolpath.beads.push_back({.x0 = 1, .y0 = 2, .z0 = 0.2, .x1 = 5, .y1 = 2, .z1 = 0.2, .width = 0.5F, .arc = -7});
    toolpath.arcs.push_back({0, 0, std::numbers::pi / 2, 8});
    toolpath.beads.push_back({.x0 = 3, .y0 = 0, .z0 = 0.2, .x1 = 0, .y1 = 3, .z1 = 0.4, .width = 0.5F, .arc = 0});
    return toolpath;
}

TEST(BeadCutter, PiecesMeetAndKeepTheirLine) {
    gcode::Toolpath toolpath = lineAndArc();
    toolpath.color_changes.push_back({.first_bead = 1, .tool = 0, .color = {1, 2, 3}});
    toolpath.color_changes.push_back({.first_bead = 2, .tool = 0, .color = {4, 5, 6}});
    BeadCutter cutter(toolpath, false, 5);
    for (const BeadPiece& piece :
         std::vector<BeadPiece>{{.bead = 0, .from = 0, .to = 0.25, .width = 0.4F},
                                {.bead = 0, .from = 0.25, .to = 1, .width = 0.6F, .drop1 = 0.1},
                                {.bead = 1, .from = 0, .to = 0.5, .width = 0.5F},
                                {.bead = 1, .from = 0.5, .to = 1, .width = 0.3F},
                                {.bead = 1, .from = 1, .to = 1, .width = 0.9F}})
        cutter.add(piece);
    cutter.finish();
    ASSERT_EQ(toolpath.beads.size(), 5U);
    for (const std::size_t first : {0U, 2U, 3U}) {
        EXPECT_EQ(double{toolpath.beads[first].x1}, double{toolpath.beads[first + 1].x0});
        EXPECT_EQ(double{toolpath.beads[first].y1}, double{toolpath.beads[first + 1].y0});
        EXPECT_EQ(double{toolpath.beads[first].z1}, double{toolpath.beads[first + 1].z0});
    }
    EXPECT_DOUBLE_EQ(toolpath.beads[0].x1, 2);
    EXPECT_DOUBLE_EQ(toolpath.beads[1].z1, 0.1);
    EXPECT_NEAR(toolpath.beads[2].x1, 3 * std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(toolpath.beads[2].z1, 0.3, 1e-12);
    for (int n = 0; n < 2; ++n) EXPECT_EQ(toolpath.lineOf(toolpath.beads[n]), 7U);
    for (int n = 2; n < 5; ++n) EXPECT_EQ(toolpath.lineOf(toolpath.beads[n]), 8U);
    EXPECT_EQ(toolpath.arcs.size(), 2U);
    EXPECT_NEAR(gcode::beadLength(toolpath, toolpath.beads[3]), std::hypot(0.75 * std::numbers::pi, 0.1), 1e-12);
    EXPECT_EQ(gcode::beadLength(toolpath, toolpath.beads[4]), 0);
    EXPECT_EQ(toolpath.color_changes[0].first_bead, 2U);
    EXPECT_EQ(toolpath.color_changes[1].first_bead, 5U);
}

}  // namespace
}  // namespace stratum::deposit

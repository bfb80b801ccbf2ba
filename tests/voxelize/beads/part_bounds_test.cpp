#include "voxelize/beads/part_outline.h"

#include "toolpaths.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace stratum::voxelize {
namespace {

// A bead along x at this y, of this feature, one layer high.
void addBead(gcode::Toolpath& toolpath, double x0, double x1, double y, gcode::Feature feature) {
    gcode::Run run;
    run.height = 0.2f;
    run.layer = 1;
    run.feature = feature;
    toolpath.runs.push_back(run);
    gcode::Bead bead;
    bead.x0 = x0;
    bead.x1 = x1;
    bead.y0 = bead.y1 = y;
    bead.z0 = bead.z1 = 0.2;
    bead.width = 0.4f;
    bead.run = static_cast<std::uint32_t>(toolpath.runs.size() - 1);
    toolpath.beads.push_back(bead);
}

Bounds boundsOfAll(const gcode::Toolpath& toolpath) {
    std::vector<std::uint32_t> all(toolpath.beads.size());
    std::iota(all.begin(), all.end(), 0U);
    return partBounds(toolpath, gcode::purposesOf(toolpath), all);
}

TEST(PartBounds, WhatIsPrintedBesideThePartDoesNotCount) {
    gcode::Toolpath toolpath;
    addBead(toolpath, -50, 60, -40, gcode::Feature::skirt);
    addBead(toolpath, 100, 140, 0, gcode::Feature::wipe_tower);
    addBead(toolpath, 0, 180, -90, gcode::Feature::custom);
    addBead(toolpath, 0, 10, 0, gcode::Feature::external_perimeter);
    addBead(toolpath, 0, 10, 8, gcode::Feature::infill);
    const Bounds part = boundsOfAll(toolpath);
    EXPECT_NEAR(part.min[0], -0.2, 1e-6);
    EXPECT_NEAR(part.max[0], 10.2, 1e-6);
    EXPECT_NEAR(part.min[1], -0.2, 1e-6);
    EXPECT_NEAR(part.max[1], 8.2, 1e-6);
    // A brim belongs to it as far as it may reach.
    addBead(toolpath, -5, 300, -3, gcode::Feature::brim);
    const Bounds with_brim = boundsOfAll(toolpath);
    EXPECT_NEAR(with_brim.min[0], -5.2, 1e-6);
    EXPECT_NEAR(with_brim.min[1], -3.2, 1e-6);
    EXPECT_NEAR(with_brim.max[0], 10.2 + kBrimReach, 1e-6);
}

TEST(PartBounds, OfAPrintThatIsNothingElse) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 180, -90, gcode::Feature::custom);
    EXPECT_NEAR(boundsOfAll(toolpath).max[0], 180.2, 1e-6);
}

TEST(PartBounds, GoesWhereThePlacementPutsIt) {
    Bounds box;
    box.include({{1, 2, 3}, {4, 6, 9}});
    Placement placement;
    placement.unit = 0.1;
    placement.offset[0] = 10;
    placement.up_y = true;
    const Bounds world = placed(box, placement);
    EXPECT_NEAR(world.min[0], 1.1, 1e-12);
    EXPECT_NEAR(world.max[0], 1.4, 1e-12);
    EXPECT_NEAR(world.min[1], 0.3, 1e-12);
    EXPECT_NEAR(world.max[1], 0.9, 1e-12);
    EXPECT_NEAR(world.min[2], -0.6, 1e-12);
    EXPECT_NEAR(world.max[2], -0.2, 1e-12);
}

}  // namespace
}  // namespace stratum::voxelize

#include "export/plan/level_set_plan.h"

#include "belt_box.h"
#include "gcode/reader.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace stratum::exporter {
namespace {

gcode::Toolpath readBelt(const test::BeltBox& box) {
    gcode::ReadOptions options;
    options.belt_angle = box.degrees;
    return gcode::readToolpath(box.program(), "box.gcode", options);
}

LevelSetChoices fine() {
    LevelSetChoices choices;
    choices.print.lattice.voxel_size = 0.0625;
    return choices;
}

openvdb::FloatGrid::Ptr voxelizedBy(const gcode::Toolpath& toolpath, const LevelSetPlan& plan) {
    openvdb::initialize();
    return voxelize::Voxelizer(toolpath, plan.selection(), plan.lattice(), plan.voxelizeOptions()).printAll();
}

// Where the level set is negative, in the world.
openvdb::BBoxd solidBox(const openvdb::FloatGrid& grid) {
    openvdb::BBoxd box;
    for (auto value = grid.cbeginValueOn(); value; ++value)
        if (*value <= 0) box.expand(grid.indexToWorld(value.getCoord()));
    return box;
}

TEST(LevelSetPlan, APrintOnABeltLiesInTheWorldAsItDoesThere) {
    for (const double degrees : {45.0, 30.0}) {
        test::BeltBox belt;
        belt.degrees = degrees;
        const gcode::Toolpath toolpath = readBelt(belt);
        ASSERT_GT(toolpath.beads.size(), 200U);
        const LevelSetPlan plan(toolpath, fine());
        const auto grid = voxelizedBy(toolpath, plan);
        const auto box = belt.box();
        const openvdb::BBoxd solid = solidBox(*grid);
        const auto part = plan.provenance("box.gcode", "", plan.selection()).part;
        ASSERT_TRUE(part);
        EXPECT_EQ(plan.lyingBounds().min[2], part->min[2]);
        for (int axis = 0; axis < 3; ++axis) {
            const auto n = static_cast<std::size_t>(axis);
            EXPECT_NEAR(part->min[axis], box[n], 1e-4) << axis;
            EXPECT_NEAR(part->max[axis], box[n + 3], 1e-4) << axis;
            EXPECT_NEAR(solid.min()[axis], box[n], 0.09) << axis;
            EXPECT_NEAR(solid.max()[axis], box[n + 3], 0.09) << axis;
        }
        // At the nearest samples of random places of the world.
        std::mt19937 random(7);
        const auto between = [&random](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        const double background = static_cast<double>(grid->background());
        const auto accessor = grid->getConstAccessor();
        int outside = 0;
        int near = 0;
        int welded = 0;
        for (int n = 0; n < 1000; ++n) {
            const openvdb::Coord at = openvdb::Coord::round(grid->worldToIndex(
                openvdb::Vec3d(between(box[0] - 0.2, box[3] + 0.2), between(box[1] - 0.2, box[4] + 0.2),
                               between(box[2] - 0.2, box[5] + 0.2))));
            const openvdb::Vec3d world = grid->indexToWorld(at);
            const double exact = belt.distance(world[0], world[1], world[2]);
            const auto value = static_cast<double>(accessor.getValue(at));
            if (exact > 0) {
                // Welds fill what is narrower than a fiftieth of a layer between two layers.
                EXPECT_LE(value, std::min(exact, background) + 2e-5) << world;
                EXPECT_GE(value, std::min(exact, background) - 0.02 * belt.layer) << world;
                welded += value < std::min(exact, background) - 2e-5 ? 1 : 0;
            } else {
                EXPECT_LE(value, 1e-5) << world;
            }
            outside += exact > 0 ? 1 : 0;
            near += std::abs(exact) < background ? 1 : 0;
        }
        EXPECT_GT(outside, 100);
        EXPECT_GT(near, 100);
        EXPECT_LT(welded, 20);
    }
}

// The nozzle touches the belt at height 0, and half a layer's ball reaches below it.
TEST(LevelSetPlan, TheFirstLineOnABeltIsAtTheBelt) {
    const test::BeltBox belt;
    const gcode::Toolpath toolpath = readBelt(belt);
    const LevelSetPlan plan(toolpath, fine());
    const auto part = plan.provenance("", "", plan.selection()).part;
    const double drop = 0.5 * belt.layer * std::sqrt(0.5);  // of the line's middle below the nozzle
    EXPECT_NEAR(part->min[2], -drop - 0.5 * (belt.width - belt.layer) * std::sqrt(0.5) - 0.5 * belt.layer, 1e-4);
    EXPECT_GT(part->min[2], -belt.width);
}

TEST(LevelSetPlan, TheOutlineOfAPrintOnABeltIsItsBoxInTheWorld) {
    const test::BeltBox belt;
    const gcode::Toolpath toolpath = readBelt(belt);
    const LevelSetPlan plan(toolpath, fine());
    const auto outline = plan.provenance("", "", plan.selection()).outline;
    const auto box = belt.box();
    ASSERT_GT(outline.size(), 20U);
    std::array<double, 6> around{1e300, 1e300, 1e300, -1e300, -1e300, -1e300};
    for (const auto& point : outline)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            around[axis] = std::min(around[axis], point[axis]);
            around[axis + 3] = std::max(around[axis + 3], point[axis]);
        }
    // Its slabs are a 32nd of the layers' extent high, which lean.
    for (std::size_t n = 0; n < 6; ++n) EXPECT_NEAR(around[n], box[n], 0.3) << n;
}

TEST(LevelSetPlan, OriginsOfAPrintOnABeltAreOfTheWorld) {
    const test::BeltBox belt;
    const gcode::Toolpath toolpath = readBelt(belt);
    LevelSetChoices choices = fine();
    choices.origin = "min";
    choices.unit = "cm";
    const auto least = LevelSetPlan(toolpath, choices).provenance("", "", {{0}});
    choices.origin = "center";
    choices.unit = "mm";
    const LevelSetPlan plan(toolpath, choices);
    const auto middle = plan.provenance("", "", plan.selection());
    for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(middle.part->min[axis], -middle.part->max[axis], 1e-9);
    EXPECT_NEAR(middle.part->min[2], 0, 1e-9);
    const openvdb::BBoxd solid = solidBox(*voxelizedBy(toolpath, plan));
    EXPECT_NEAR(solid.min()[2], 0, 0.09);
    EXPECT_GE(solid.min()[2], 0);
    for (int axis = 0; axis < 3; ++axis) EXPECT_GE(least.part->min[axis], -1e-9);
}

}  // namespace
}  // namespace stratum::exporter

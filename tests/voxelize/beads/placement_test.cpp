#include "voxelize/beads/placement.h"

#include "toolpaths.h"
#include "voxelize/beads/part_outline.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace stratum::voxelize {
namespace {

const Placement kMoved{.unit = 0.1, .offset = {3, -2, 1}, .up_y = true, .tilt = 35};

TEST(Placement, GoesAndComesBack) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> mm(-300, 300);
    for (const Placement& placement : {Placement{}, Placement{.tilt = 45}, kMoved})
        for (int n = 0; n < 100; ++n) {
            const std::array<double, 3> place{mm(random), mm(random), mm(random)};
            const auto back = printOf(worldOf(place, placement), placement);
            for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(back[axis], place[axis], 1e-12 * 300);
        }
}

// y leads up the gantry: half along the belt and half up. z, across the layers, leads back along the belt and up.
TEST(Placement, TiltTurnsAboutX) {
    const double half = std::sqrt(0.5);
    const auto up_the_gantry = worldOf({0, 1, 0}, {.tilt = 45});
    EXPECT_NEAR(up_the_gantry[1], half, 1e-15);
    EXPECT_NEAR(up_the_gantry[2], half, 1e-15);
    const auto across = worldOf({0, 0, 1}, {.tilt = 45});
    EXPECT_NEAR(across[1], -half, 1e-15);
    EXPECT_NEAR(across[2], half, 1e-15);
    EXPECT_EQ(worldOf({1, 0, 0}, {.tilt = 45})[0], 1);
}

TEST(Placement, TransformsPutSamplesWherePlacesGo) {
    Lattice lattice;
    lattice.voxel_size = 0.05;
    lattice.origin_z = 0.013;
    for (const Placement& placement : {Placement{}, Placement{.tilt = 5}, Placement{.tilt = 85}, kMoved}) {
        const auto transform = makeTransform(lattice, placement);
        EXPECT_NEAR(transform->voxelVolume(), std::pow(0.05 * placement.unit, 3), 1e-15);
        for (const openvdb::Coord& at : {openvdb::Coord(0), openvdb::Coord(7, -400, 90), openvdb::Coord(-1, 3000, 2)}) {
            const openvdb::Vec3d world = transform->indexToWorld(at);
            const auto expected = worldOf({at.x() * 0.05, at.y() * 0.05, at.z() * 0.05 + 0.013}, placement);
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_NEAR(world[axis], expected[static_cast<std::size_t>(axis)], 1e-12);
        }
    }
}

// By many points of the solid.
TEST(Placement, BoundsOfATurnedPrintAreTight) {
    for (const auto& [width, height, climb] : {std::array{0.5, 0.2, 0.0}, {0.15, 0.2, 0.0}, {0.6, 0.3, 1.0}}) {
        gcode::Toolpath toolpath;
        addBead(toolpath, 1, 2, 4 + climb, 3, 4.5, 4, width, height);
        const BeadField field(toolpath, toolpath.beads[0]);
        const Bounds own = field.bounds();
        for (const double tilt : {15.0, 45.0, 80.0}) {
            const Placement placement{.tilt = tilt};
            Bounds sampled;
            constexpr double kStep = 0.01;
            for (double x = own.min[0]; x <= own.max[0]; x += kStep)
                for (double y = own.min[1]; y <= own.max[1]; y += kStep)
                    for (double z = own.min[2]; z <= own.max[2]; z += kStep) {
                        if (field.distance(x, y, z) > 0) continue;
                        const auto [wx, wy, wz] = worldOf({x, y, z}, placement);
                        sampled.include({{wx, wy, wz}, {wx, wy, wz}});
                    }
            const Bounds bounds = boundsOf(toolpath, std::array<std::uint32_t, 1>{0}, tilt);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_LE(bounds.min[axis], sampled.min[axis] + 1e-9);
                EXPECT_GE(bounds.max[axis], sampled.max[axis] - 1e-9);
                EXPECT_NEAR(bounds.min[axis], sampled.min[axis], climb > 0 ? 0.1 : 2 * kStep) << width << " " << tilt;
                EXPECT_NEAR(bounds.max[axis], sampled.max[axis], climb > 0 ? 0.1 : 2 * kStep) << width << " " << tilt;
            }
        }
    }
}

TEST(Placement, OriginsAreOfTheTurnedBox) {
    Bounds turned;
    turned.include({{10, -60, -0.5}, {30, -20, 25}});
    const Placement center = placementOf("mm", "z", "center", turned, 45);
    EXPECT_EQ(center.tilt, 45);
    EXPECT_EQ(center.offset[0], -20);
    EXPECT_EQ(center.offset[1], 40);
    EXPECT_EQ(center.offset[2], 0.5);
    const Bounds placed_box = placed(turned, placementOf("cm", "z", "min", turned, 45));
    EXPECT_NEAR(placed_box.min[1], 0, 1e-15);
    EXPECT_NEAR(placed_box.max[2], 2.55, 1e-15);
}

}  // namespace
}  // namespace stratum::voxelize

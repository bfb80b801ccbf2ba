// Columns with far more beads than any print has: the work in them is bounded.
#include "same_grids.h"
#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdint>

namespace stratum::voxelize {
namespace {

using test::addBead;
using test::allBeads;

// The same bytes by one thread and by two.
openvdb::FloatGrid::Ptr gridOf(const gcode::Toolpath& toolpath, double voxel) {
    Lattice lattice;
    lattice.voxel_size = voxel;
    lattice.half_width = 3;
    const auto beads = allBeads(toolpath);
    openvdb::FloatGrid::Ptr grid = voxelize(toolpath, beads, lattice);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    test::expectSame(*grid, *voxelize(toolpath, beads, lattice));
    return grid;
}

// Every one of the planes touches hundreds of others.
TEST(CrowdedColumn, PlanesTenNanometresApartBesideATallBead) {
    gcode::Toolpath toolpath;
    constexpr int kPlanes = 10000;
    for (int n = 0; n < kPlanes; ++n) {
        const double z = 0.05 + 1e-5 * n;
        addBead(toolpath, 0, 0, z, 1, 0, z, 0.45, 0.05);
    }
    addBead(toolpath, 0, 3, 8, 1, 3, 8, 9, 8);
    const auto grid = gridOf(toolpath, 0.1);
    EXPECT_LT(grid->tree().getValue({5, 0, 1}), 0);
    EXPECT_LT(grid->tree().getValue({5, 30, 40}), 0);
}

// All of them between the same two neighbours.
TEST(CrowdedColumn, ThousandsOfBeadsThatFillOneGroove) {
    gcode::Toolpath toolpath;
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    constexpr int kBeads = 20000;
    for (int n = 0; n < kBeads; ++n) {
        const double y = 0.4 * (n % 2) + 1e-6 * n;
        addBead(toolpath, 0, y, 0.2, 2, y, 0.2, 0.45, 0.2);
    }
    const auto grid = gridOf(toolpath, 0.05);
    EXPECT_LT(grid->tree().getValue({20, 4, 2}), 0);
}

}  // namespace
}  // namespace stratum::voxelize

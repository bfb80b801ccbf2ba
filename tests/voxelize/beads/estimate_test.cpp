#include "voxelize/beads/estimate.h"

#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

namespace stratum::voxelize {
namespace {

TEST(Estimate, IsRightWithinAFactorOfThreeFromCoarseToFine) {
    // A dense block: beads side by side, twelve layers.
    gcode::Toolpath toolpath;
    for (std::uint32_t layer = 1; layer <= 12; ++layer)
        for (double y = 0; y < 6; y += 0.4)
            test::addBead(toolpath, 0, y, 0.2 * layer, 8, y, 0.2 * layer, 0.45, 0.2, layer);
    const auto beads = test::allBeads(toolpath);
    for (const double voxel : {0.1, 0.05, 0.02}) {
        Lattice lattice;
        lattice.voxel_size = voxel;
        const auto active = static_cast<double>(voxelize(toolpath, beads, lattice)->activeVoxelCount());
        const double estimate = estimateActiveVoxels(toolpath, beads, voxel, 3);
        EXPECT_GT(estimate, active / 3) << voxel;
        EXPECT_LT(estimate, active * 3) << voxel;
    }
}

TEST(Estimate, GrowsWithTheSquareOfFineness) {
    gcode::Toolpath toolpath;
    test::addBead(toolpath, 0, 0, 0.2, 50, 0, 0.2, 0.5, 0.2);
    const auto beads = test::allBeads(toolpath);
    EXPECT_NEAR(estimateActiveVoxels(toolpath, beads, 1e-4, 3) / estimateActiveVoxels(toolpath, beads, 1e-3, 3), 100,
                1e-6);
}

}  // namespace
}  // namespace stratum::voxelize

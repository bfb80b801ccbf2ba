#include "report/level_set/solid_sums.h"

#include "reported_print.h"
#include "voxelize/grid/solid_check.h"

#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <numbers>

namespace stratum::report {
namespace {

TEST(SolidSums, OfASphereOffTheOrigin) {
    // 20 voxels of radius, about a place that no symmetry helps.
    const openvdb::Vec3f middle(13.3F, -7.1F, 4.6F);
    const auto sphere = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(20, middle, 1);
    const LeafMap map(*sphere);
    const Outside outside(map, 0.5, 1, 3);
    const SolidSums sums = sumSolid(map, sphere->background(), 1, &outside);
    const double volume = 4.0 / 3 * std::numbers::pi * 8000;
    EXPECT_NEAR(sums.volume, volume, 2e-4 * volume);
    EXPECT_NEAR(sums.volume, voxelize::enclosedVolume(*sphere), 2e-3 * volume);
    double rows = 0;
    for (const RowSums& row : sums.rows) {
        rows += row.solid;
        EXPECT_EQ(row.open + row.closed, 0);
    }
    EXPECT_NEAR(rows, sums.volume, 1e-6 * volume);
    double center[3];
    for (int axis = 0; axis < 3; ++axis) {
        center[axis] = sums.first[axis] / sums.volume;
        EXPECT_NEAR(center[axis], static_cast<double>(middle[axis]), 1e-3);
    }
    const int kIndex[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
            const double moment = sums.second[kIndex[a][b]] - sums.volume * center[a] * center[b];
            const double exact = a == b ? volume * 80 : 0;
            EXPECT_NEAR(moment, exact, 5e-3 * volume * 80);
        }
    const double area = 4 * std::numbers::pi * 400;
    EXPECT_NEAR(sums.outer_area, area, 3e-3 * area);
    EXPECT_EQ(sums.inner_area, 0);
}

// Solid gaps between leaves count as whole cells.
TEST(SolidSums, OfALargeBoxWithTiles) {
    openvdb::FloatGrid grid(3);
    const auto value = [](int x, int y, int z) {
        return std::max({std::abs(x - 0.5), std::abs(y - 0.5), std::abs(z - 0.5)}) - 50;
    };
    for (int x = -56; x < 64; ++x)
        for (int y = -56; y < 64; ++y)
            for (int z = -56; z < 64; ++z) {
                const double v = value(x, y, z);
                if (std::abs(v) < 3)
                    grid.tree().setValueOn({x, y, z}, static_cast<float>(v));
                else if (v < 0)
                    grid.tree().setValueOff({x, y, z}, -3.0F);
            }
    grid.tree().prune();
    const LeafMap map(grid);
    EXPECT_LT(map.leafCount(), 15U * 15 * 15 - 500);
    const Outside outside(map, 0.5, 1, 3);
    const SolidSums sums = sumSolid(map, 3, 1, &outside);
    EXPECT_NEAR(sums.volume, 1e6, 300);
    EXPECT_NEAR(sums.first[0] / sums.volume, 0.5, 1e-3);
    EXPECT_NEAR(sums.second[0] / sums.volume - 0.25, 10000.0 / 12, 1);
    // The cells of the edges cut them off.
    EXPECT_NEAR(sums.outer_area, 60000 - 1200 * (1 - std::sqrt(0.5)), 10);
}

}  // namespace
}  // namespace stratum::report

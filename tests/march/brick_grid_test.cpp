#include "march/brick_grid.h"

#include "spheres.h"

#include <gtest/gtest.h>

namespace stratum::march {
namespace {

TEST(Mask64, EmptyEdgeIsTheLargestAlignedEmptyBlock) {
    EXPECT_EQ(Mask64::emptyEdge(0, 1, 2, 3), 4);
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = 0; z < 4; ++z) {
                const std::uint64_t one = std::uint64_t{1} << Mask64::bit(x, y, z);
                EXPECT_EQ(Mask64::emptyEdge(one, x, y, z), 0);
                EXPECT_EQ(Mask64::emptyEdge(~one, x, y, z), 1);
                EXPECT_EQ(Mask64::emptyEdge(one, x ^ 1, y, z), 1);  // the same group
                EXPECT_EQ(Mask64::emptyEdge(one, x ^ 2, y, z), 2);  // another group
            }
}

TEST(BrickGrid, HoldsEverySurfaceCellAndItsCorners) {
    // Not aligned with anything, in all octants.
    const auto grid = test::sphereGrid(3.3F, openvdb::Vec3f(-1.7F, 2.9F, 0.4F), 0.1F);
    const BrickGrid bricks(*grid);
    const auto accessor = grid->getConstAccessor();
    const auto size = bricks.size();
    std::size_t surface_cells = 0;
    for (int x = 0; x < size[0]; ++x)
        for (int y = 0; y < size[1]; ++y)
            for (int z = 0; z < size[2]; ++z) {
                const openvdb::Coord at = bricks.origin().offsetBy(x, y, z);
                bool mixed = false;
                float corner[8];
                for (int c = 0; c < 8; ++c) {
                    corner[c] = accessor.getValue(at.offsetBy(c >> 2, c >> 1 & 1, c & 1));
                    mixed = mixed || (corner[c] < 0) != (corner[0] < 0);
                }
                const MacroCell& macro = bricks.macroCell(x / 32, y / 32, z / 32);
                const int bx = x / 8 & 3;
                const int by = y / 8 & 3;
                const int bz = z / 8 & 3;
                bool stored = false;
                if ((macro.bricks >> Mask64::bit(bx, by, bz) & 1) != 0) {
                    const std::size_t brick = BrickGrid::brickIndex(macro, bx, by, bz);
                    const std::uint64_t word = bricks.surface(
                        brick)[static_cast<std::size_t>((x >> 2 & 1) << 2 | (y >> 2 & 1) << 1 | (z >> 2 & 1))];
                    stored = (word >> Mask64::bit(x & 3, y & 3, z & 3) & 1) != 0;
                    const float* v =
                        bricks.samples(brick) + (x & 7) * BrickGrid::kStrideX + (y & 7) * BrickGrid::kStrideY + (z & 7);
                    for (int c = 0; c < 8; ++c)
                        ASSERT_EQ(v[(c >> 2) * BrickGrid::kStrideX + (c >> 1 & 1) * BrickGrid::kStrideY + (c & 1)],
                                  corner[c]);
                }
                ASSERT_EQ(stored, mixed) << at;
                surface_cells += mixed ? 1 : 0;
            }
    EXPECT_GT(surface_cells, 10000U);
}

TEST(BrickGrid, EmptyRadiusIsTheChebyshevDistance) {
    auto grid = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    // A second part far away, to open a wide space between.
    auto far = test::sphereGrid(1, openvdb::Vec3f(21, 13, 8), 0.1F);
    for (auto it = far->cbeginValueOn(); it; ++it) grid->tree().setValueOn(it.getCoord(), *it);
    const BrickGrid bricks(*grid);
    const int n[3] = {bricks.size()[0] / 32, bricks.size()[1] / 32, bricks.size()[2] / 32};
    for (int x = 0; x < n[0]; ++x)
        for (int y = 0; y < n[1]; ++y)
            for (int z = 0; z < n[2]; ++z) {
                int nearest = 1 << 20;
                for (int a = 0; a < n[0]; ++a)
                    for (int b = 0; b < n[1]; ++b)
                        for (int c = 0; c < n[2]; ++c)
                            if (bricks.macroCell(a, b, c).bricks != 0)
                                nearest =
                                    std::min(nearest, std::max({std::abs(a - x), std::abs(b - y), std::abs(c - z)}));
                ASSERT_EQ(bricks.macroCell(x, y, z).empty_radius, static_cast<std::uint32_t>(nearest));
            }
}

}  // namespace
}  // namespace stratum::march

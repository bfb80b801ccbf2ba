#include "march/brick/brick_grid.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "march/brick/brick_walk.h"
#include "spheres.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <vector>

namespace stratum::march {
namespace {

TEST(Mask64, EmptyEdgeIsTheLargestAlignedBlockWithNothingAhead) {
    std::mt19937_64 random(1);
    int found[5] = {};
    for (int n = 0; n < 4000; ++n) {
        // From almost empty to almost full.
        std::uint64_t mask = random() & random();
        for (int k = n % 6; k > 0; --k) mask &= random();
        if (n % 7 == 0) mask = ~mask;
        const int x = static_cast<int>(random() % 4);
        const int y = static_cast<int>(random() % 4);
        const int z = static_cast<int>(random() % 4);
        const auto octant = static_cast<Octant>(random() % 8);
        const auto isEmpty = [&](int edge, bool ahead) {
            for (int at = 0; at < 64; ++at) {
                const int from[3] = {x, y, z};
                const int to[3] = {at >> 4, at >> 2 & 3, at & 3};
                bool in = (mask >> at & 1) != 0;
                for (int axis = 0; axis < 3; ++axis) {
                    in = in && from[axis] / edge == to[axis] / edge;
                    const bool descends = (octant & 4U >> axis) != 0;
                    if (ahead) in = in && (descends ? to[axis] <= from[axis] : to[axis] >= from[axis]);
                }
                if (in) return false;
            }
            return true;
        };
        const int edge = isEmpty(4, true) ? 4 : isEmpty(2, false) ? 2 : isEmpty(1, false) ? 1 : 0;
        ASSERT_EQ(Mask64::emptyEdge(mask, x, y, z, octant), edge) << n;
        ++found[edge];
    }
    for (const int edge : {0, 1, 2, 4}) EXPECT_GT(found[edge], 100) << edge;
}

// Every cell of the grid: is it marked if and only if its corners are not of one sign, and are they its samples?
void expectAllCells(const openvdb::FloatGrid& grid, const BrickGrid& bricks) {
    const auto accessor = grid.getConstAccessor();
    const auto size = bricks.size();
    const double tolerance = bricks.values() == BrickValues::Float32 ? 0.0 : 0.5 * bricks.unit() * (1 + 1e-4);
    std::size_t surface_cells = 0;
    for (int x = 0; x < size[0]; ++x)
        for (int y = 0; y < size[1]; ++y)
            for (int z = 0; z < size[2]; ++z) {
                const openvdb::Coord at = bricks.origin().offsetBy(x, y, z);
                bool mixed = false;
                std::array<double, 8> corner{};
                for (int c = 0; c < 8; ++c) {
                    corner[static_cast<std::size_t>(c)] =
                        static_cast<double>(accessor.getValue(at.offsetBy(c >> 2, c >> 1 & 1, c & 1)));
                    mixed = mixed || (corner[static_cast<std::size_t>(c)] < 0) != (corner[0] < 0);
                }
                const Block block = findBlock(bricks, {x, y, z});
                ASSERT_EQ(block.surface, mixed) << at;
                surface_cells += mixed ? 1 : 0;
                if (!mixed) continue;
                const Corners stored = cornersOf(bricks, block.brick, {x, y, z});
                for (std::size_t c = 0; c < 8; ++c) {
                    ASSERT_EQ(stored[c] < 0, corner[c] < 0);
                    ASSERT_NEAR(stored[c] * bricks.unit(), corner[c], tolerance);
                }
            }
    EXPECT_GT(surface_cells, 10000U);
}

TEST(BrickGrid, HoldsEverySurfaceCellAndItsCorners) {
    // Not aligned with anything, in all octants.
    const auto grid = test::sphereGrid(3.3F, openvdb::Vec3f(-1.7F, 2.9F, 0.4F), 0.1F);
    for (const BrickValues values : {BrickValues::Float32, BrickValues::Int16}) {
        expectAllCells(*grid, BrickGrid(*grid, values));
        const BrickGrid lazy(std::make_shared<GridLeaves>(*grid), values);
        EXPECT_EQ(lazy.brickCount(), 0U);
        expectAllCells(*grid, lazy);
        EXPECT_EQ(lazy.brickCount(), BrickGrid(*grid, values).brickCount());
    }
}

TEST(BrickGrid, KeepsSixteenBitsInSixteenHundredBytesABrick) {
    const auto grid = test::sphereGrid(3.3F, openvdb::Vec3f(0), 0.03F);
    const BrickGrid bricks(*grid, BrickValues::Int16);
    EXPECT_GT(bricks.brickCount(), 1000U);
    EXPECT_LE(bricks.bytes(), 1600 * bricks.brickCount());
}

TEST(BrickGrid, LaysLazyBricksOutOnceForAllThreads) {
    const auto grid = test::sphereGrid(3.3F, openvdb::Vec3f(0), 0.1F);
    const BrickGrid all(*grid, BrickValues::Int16);
    const BrickGrid lazy(std::make_shared<GridLeaves>(*grid), BrickValues::Int16);
    const auto size = lazy.size();
    // All threads at the same bricks.
    parallelFor(8, 1, [&](std::size_t, std::size_t) {
        for (int x = 0; x < size[0]; x += 2)
            for (int y = 0; y < size[1]; y += 2)
                for (int z = 0; z < size[2]; z += 2) (void)findBlock(lazy, {x, y, z});
    });
    EXPECT_EQ(lazy.brickCount(), all.brickCount());
    expectAllCells(*grid, lazy);
}

TEST(BrickGrid, HoldsEveryCellInWhateverRoomThereIs) {
    const auto grid = test::sphereGrid(3.3F, openvdb::Vec3f(-1.7F, 2.9F, 0.4F), 0.1F);
    const std::size_t all = BrickGrid(*grid, BrickValues::Int16).brickCount();
    for (const BrickValues values : {BrickValues::Float32, BrickValues::Int16}) {
        const std::size_t brick = BrickGrid(*grid, values).brickBytes();
        const BrickGrid lazy(std::make_shared<GridLeaves>(*grid), values, BrickSlots::kLeastBound * brick + 1);
        const BrickSlots::Reading reading(lazy.cache());
        // Twice: once what is asked for again has been evicted.
        for (int round = 0; round < 2; ++round) {
            expectAllCells(*grid, lazy);
            EXPECT_LE(lazy.brickCount(), BrickSlots::kLeastBound);
            EXPECT_EQ(lazy.cache().counts().peak, BrickSlots::kLeastBound);
        }
        EXPECT_GT(lazy.cache().counts().made, all);
    }
}

TEST(BrickGrid, RefusesRoomForFewerBricksThanRaysNeed) {
    const auto grid = test::sphereGrid(3.3F, openvdb::Vec3f(0), 0.1F);
    const auto source = std::make_shared<GridLeaves>(*grid);
    const std::size_t least = BrickSlots::kLeastBound * BrickGrid(*grid, BrickValues::Int16).brickBytes();
    EXPECT_NO_THROW(BrickGrid(source, BrickValues::Int16, least));
    EXPECT_THROW(BrickGrid(source, BrickValues::Int16, least - 1), UsageError);
    EXPECT_THROW(BrickGrid(source, BrickValues::Float32, least), UsageError);
}

TEST(BrickGrid, RefusesLeavesThatAreTooFarApart) {
    const auto grid = openvdb::FloatGrid::create(3.0f);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    // A diagonal of leaves: a box of 150^3 macro cells for 150 of them, 54 MB.
    for (int n = 0; n < 150; ++n) grid->tree().setValue(openvdb::Coord(32 * n), -1.0f);
    EXPECT_THROW(BrickGrid(*grid, BrickValues::Float32), InputError);
    const auto near = openvdb::FloatGrid::create(3.0f);
    near->setGridClass(openvdb::GRID_LEVEL_SET);
    for (int n = 0; n < 100; ++n) near->tree().setValue(openvdb::Coord(32 * n), -1.0f);
    EXPECT_NO_THROW(BrickGrid(*near, BrickValues::Float32));
}

TEST(BrickGrid, EmptyCubesAheadAreTheLargest) {
    auto grid = test::sphereGrid(1, openvdb::Vec3f(0), 0.1F);
    // A second part far away, to open a wide space between.
    auto far = test::sphereGrid(1, openvdb::Vec3f(21, 13, 8), 0.1F);
    for (auto it = far->cbeginValueOn(); it; ++it) grid->tree().setValueOn(it.getCoord(), *it);
    const BrickGrid bricks(*grid, BrickValues::Int16);
    const glm::ivec3 n(bricks.size()[0] / 32, bricks.size()[1] / 32, bricks.size()[2] / 32);
    std::vector<glm::ivec3> occupied;
    const auto forAll = [&n](const auto& visit) {
        for (int x = 0; x < n.x; ++x)
            for (int y = 0; y < n.y; ++y)
                for (int z = 0; z < n.z; ++z) visit(glm::ivec3(x, y, z));
    };
    forAll([&](const glm::ivec3& at) {
        if (bricks.macroCell(at.x, at.y, at.z).bricks != 0) occupied.push_back(at);
    });
    ASSERT_GE(occupied.size(), 2U);
    forAll([&](const glm::ivec3& at) {
        const MacroCell& macro = bricks.macroCell(at.x, at.y, at.z);
        if (macro.bricks != 0) return;
        for (unsigned octant = 0; octant < 8; ++octant) {
            const glm::ivec3 way((octant & 4) != 0 ? -1 : 1, (octant & 2) != 0 ? -1 : 1, (octant & 1) != 0 ? -1 : 1);
            int nearest = 255;
            for (const glm::ivec3& other : occupied) {
                const glm::ivec3 ahead = (other - at) * way;
                if (ahead.x >= 0 && ahead.y >= 0 && ahead.z >= 0)
                    nearest = std::min(nearest, std::max({ahead.x, ahead.y, ahead.z}));
            }
            ASSERT_EQ(macro.emptyAhead(octant), nearest) << at.x << ' ' << at.y << ' ' << at.z << ' ' << octant;
        }
    });
}

}  // namespace
}  // namespace stratum::march

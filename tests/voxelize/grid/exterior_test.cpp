// Culling: what the outside sees must not change, and what it can't see must not be there.
#include "voxelize/grid/exterior.h"

#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Diagnostics.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace stratum::voxelize {
namespace {

using test::addBead;
using test::allBeads;

// A box of `edge` mm: solid floor and lid of three layers, walls of two lines, hollow. `hole` (mm) is the width of a
// slot through one wall, as deep as the wall and four layers tall.
gcode::Toolpath box(double hole = 0, bool lid = true) {
    gcode::Toolpath toolpath;
    constexpr double kEdge = 8;
    constexpr double kSpacing = 0.407;  // 0.45 - 0.2 (1 - pi / 4)
    const int layers = 30;
    for (int layer = 0; layer < layers; ++layer) {
        const double z = 0.2 * (layer + 1);
        const auto number = static_cast<std::uint32_t>(layer + 1);
        for (const double inset : {0.0, kSpacing}) {
            const double a = inset;
            const double b = kEdge - inset;
            if (hole > 0 && layer >= 12 && layer < 16) {
                // The round ends of the two halves leave a gap of `hole`.
                const double end = 0.5 * (hole + 0.45);
                addBead(toolpath, a, a, z, kEdge / 2 - end, a, z, 0.45, 0.2, number);
                addBead(toolpath, kEdge / 2 + end, a, z, b, a, z, 0.45, 0.2, number);
            } else {
                addBead(toolpath, a, a, z, b, a, z, 0.45, 0.2, number);
            }
            addBead(toolpath, b, a, z, b, b, z, 0.45, 0.2, number);
            addBead(toolpath, b, b, z, a, b, z, 0.45, 0.2, number);
            addBead(toolpath, a, b, z, a, a, z, 0.45, 0.2, number);
        }
        if (layer < 3 || (lid && layer >= layers - 3))
            for (double y = 2 * kSpacing; y < kEdge - kSpacing; y += kSpacing)
                addBead(toolpath, kSpacing, y, z, kEdge - kSpacing, y, z, 0.45, 0.2, number);
    }
    return toolpath;
}

openvdb::FloatGrid::Ptr build(const gcode::Toolpath& toolpath, double voxel, Interior interior) {
    Lattice lattice;
    lattice.voxel_size = voxel;
    lattice.layer_height = 0.2;
    VoxelizeOptions options;
    options.interior = interior;
    return voxelize(toolpath, allBeads(toolpath), lattice, options);
}

double at(const openvdb::FloatGrid& grid, double x, double y, double z) {
    return grid.getConstAccessor().getValue(openvdb::Coord::round(grid.worldToIndex(openvdb::Vec3d(x, y, z))));
}

TEST(Exterior, FillsAClosedVoidAndKeepsTheOutside) {
    const gcode::Toolpath toolpath = box();
    for (const double voxel : {0.1, 0.05}) {
        const auto keep = build(toolpath, voxel, Interior::keep);
        const auto cull = build(toolpath, voxel, Interior::cull);
        EXPECT_GT(at(*keep, 4, 4, 3), 0);
        EXPECT_LT(at(*cull, 4, 4, 3), 0);
        EXPECT_EQ(cull->tree().probeConstLeaf(openvdb::Coord::round(cull->worldToIndex(openvdb::Vec3d(4, 4, 3)))),
                  nullptr);
        EXPECT_LT(2 * cull->activeVoxelCount(), keep->activeVoxelCount());
        // Everything that is not filled has its old value: an outside sample never turns into another outside value,
        // and near the surface the inside is as before.
        const auto accessor = keep->getConstAccessor();
        std::size_t outside = 0;
        for (auto voxel_on = cull->cbeginValueOn(); voxel_on; ++voxel_on) {
            ASSERT_EQ(*voxel_on, accessor.getValue(voxel_on.getCoord()));
            if (*voxel_on >= 0) ++outside;
        }
        EXPECT_GT(outside, 10000U);
        // All of the outer band is there: sample beyond each of the six sides.
        for (const openvdb::Vec3d& p :
             {openvdb::Vec3d(-0.3, 4, 3), openvdb::Vec3d(8.3, 4, 3), openvdb::Vec3d(4, -0.3, 3),
              openvdb::Vec3d(4, 8.3, 3), openvdb::Vec3d(4, 4, -0.05), openvdb::Vec3d(4, 4, 6.05)})
            EXPECT_EQ(at(*keep, p[0], p[1], p[2]), at(*cull, p[0], p[1], p[2]));
        EXPECT_EQ(openvdb::tools::checkLevelSet(*cull, 6), "");
    }
}

TEST(Exterior, SignsAreComplete) {
    const auto grid = build(box(), 0.1, Interior::cull);
    const auto filled = grid->deepCopy();
    openvdb::tools::signedFloodFill(filled->tree());
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf)
        EXPECT_EQ(
            std::memcmp(leaf->buffer().data(), filled->tree().probeConstLeaf(leaf->origin())->buffer().data(), 2048),
            0);
    EXPECT_LT(at(*grid, 4, 4, 3), 0);
    EXPECT_GT(at(*grid, 40, 4, 3), 0);
}

TEST(Exterior, SeesThroughAWideSlotAndNotThroughANarrowOne) {
    // 0.35 mm at a tenth of a millimetre a voxel is passed. Ends that overlap by 0.12 mm leave notches between their
    // roundings, narrower than a voxel.
    EXPECT_GT(at(*build(box(0.35), 0.1, Interior::cull), 4, 4, 3), 0);
    EXPECT_LT(at(*build(box(-0.12), 0.1, Interior::cull), 4, 4, 3), 0);
}

TEST(Exterior, AnOpenBoxShowsItsInside) {
    const gcode::Toolpath toolpath = box(0, false);
    const auto keep = build(toolpath, 0.1, Interior::keep);
    const auto cull = build(toolpath, 0.1, Interior::cull);
    EXPECT_GT(at(*cull, 4, 4, 3), 0);
    for (double x = 0.6; x < 7.4; x += 0.1)
        for (double z = 0.5; z < 6; z += 0.1)
            if (at(*keep, x, 4, z) >= 0) {
                ASSERT_EQ(at(*keep, x, 4, z), at(*cull, x, 4, z));
            }
}

TEST(Exterior, ForecastsWhatItWouldKeep) {
    for (const bool lid : {true, false}) {
        const gcode::Toolpath toolpath = box(0, lid);
        Lattice lattice;
        lattice.voxel_size = 0.1;
        lattice.layer_height = 0.2;
        Voxelizer kept(toolpath, allBeads(toolpath), lattice);
        const auto whole = kept.printAll();
        const std::size_t leaves = whole->tree().leafCount();
        const CullForecast forecast = kept.forecastCull();
        const auto culled = build(toolpath, 0.1, Interior::cull);
        EXPECT_EQ(forecast.leaves, culled->tree().leafCount());
        EXPECT_EQ(forecast.active_voxels, culled->activeVoxelCount());
        if (lid) {
            EXPECT_LT(forecast.leaves, leaves);
        }
        // Nothing of the grid changes by looking.
        EXPECT_EQ(whole->tree().leafCount(), leaves);
    }
}

TEST(Exterior, ProgressGrowsAndEnds) {
    const gcode::Toolpath toolpath = box();
    Lattice lattice;
    lattice.voxel_size = 0.1;
    lattice.layer_height = 0.2;
    VoxelizeOptions options;
    options.interior = Interior::cull;
    std::vector<double> told;
    options.progress = [&told](double share) { told.push_back(share); };
    voxelize(toolpath, allBeads(toolpath), lattice, options);
    ASSERT_FALSE(told.empty());
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_GT(told.front(), 0);
    EXPECT_EQ(told.back(), 1);
}

// What was made by then is LeakSanitizer's to look for.
TEST(Exterior, AFailureOnTheWayPassesThrough) {
    const gcode::Toolpath toolpath = box();
    Lattice lattice;
    lattice.voxel_size = 0.1;
    lattice.layer_height = 0.2;
    VoxelizeOptions options;
    options.progress = [](double done) {
        if (done > 0.2) throw std::runtime_error("enough");
    };
    for (const Interior interior : {Interior::keep, Interior::cull}) {
        options.interior = interior;
        EXPECT_THROW(voxelize(toolpath, allBeads(toolpath), lattice, options), std::runtime_error);
    }
}

TEST(Exterior, OneThreadOrTwoTheSameLeaves) {
    const gcode::Toolpath toolpath = box(0.35);
    openvdb::FloatGrid::Ptr grids[2];
    for (std::size_t n = 0; n < 2; ++n) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n + 1);
        grids[n] = build(toolpath, 0.05, Interior::cull);
    }
    ASSERT_TRUE(grids[0]->tree().hasSameTopology(grids[1]->tree()));
    auto other = grids[1]->tree().cbeginLeaf();
    for (auto leaf = grids[0]->tree().cbeginLeaf(); leaf; ++leaf, ++other)
        ASSERT_EQ(std::memcmp(leaf->buffer().data(), other->buffer().data(), 2048), 0);
}

}  // namespace
}  // namespace stratum::voxelize

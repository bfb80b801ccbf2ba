#include "voxelize/grid/voxelizer.h"

#include "base/error.h"
#include "plain_field.h"
#include "same_grids.h"
#include "toolpaths.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Diagnostics.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/global_control.h>

#include <random>

namespace stratum::voxelize {
namespace {

using test::addArc;
using test::addBead;
using test::allBeads;

Lattice latticeOf(double voxel, double half_width = 3) {
    Lattice lattice;
    lattice.voxel_size = voxel;
    lattice.half_width = half_width;
    return lattice;
}

// A few layers of walls, infill and an arc, stacked flat on flat: the shape of a real print, small.
gcode::Toolpath smallPrint() {
    gcode::Toolpath toolpath;
    for (int layer = 0; layer < 6; ++layer) {
        const double z = 0.2 * (layer + 1);
        const auto number = static_cast<std::uint32_t>(layer + 1);
        for (const double inset : {0.0, 0.42}) {
            const double a = inset;
            const double b = 6 - inset;
            addBead(toolpath, a, a, z, b, a, z, 0.45, 0.2, number);
            addBead(toolpath, b, a, z, b, b, z, 0.45, 0.2, number);
            addBead(toolpath, b, b, z, a, b, z, 0.45, 0.2, number);
            addBead(toolpath, a, b, z, a, a, z, 0.45, 0.2, number);
        }
        for (double y = 1.2; y < 5; y += 1.3) addBead(toolpath, 1, y + 0.1 * (layer % 2), z, 5, y, z, 0.5, 0.2, number);
        addArc(toolpath, 9, 3, 1.7, 0.3, layer % 2 == 0 ? 5.0 : -2.0, z, z, 0.6, 0.2, number);
    }
    return toolpath;
}

// The first eight of OpenVDB's checks hold everywhere. Its ninth, a gradient norm near one at every zero crossing, is a
// heuristic for smooth bodies: between creases a voxel or two apart it fails for any field, OpenVDB's own
// levelSetRebuild of the same print included, and must then be the only complaint.
void expectNothingWrong(const openvdb::FloatGrid& grid) {
    EXPECT_EQ(openvdb::tools::checkLevelSet(grid, 8), "");
    const std::string ninth = openvdb::tools::checkLevelSet(grid, 9);
    EXPECT_TRUE(ninth.empty() || ninth.find("NormGrad") != std::string::npos) << ninth;
}

TEST(Voxelizer, EveryVoxelAgreesWithBruteForce) {
    const gcode::Toolpath toolpath = smallPrint();
    const test::BruteForce brute(toolpath);
    for (const double voxel : {0.1, 0.05, 0.037}) {
        const Lattice lattice = latticeOf(voxel);
        const auto grid = voxelize(toolpath, allBeads(toolpath), lattice);
        const auto accessor = grid->getConstAccessor();
        openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
        box.expand(2);
        const float background = grid->background();
        std::size_t compared = 0;
        for (auto c = box.begin(); c; ++c) {
            const openvdb::Vec3d p = grid->indexToWorld(*c);
            const double expected = brute(p[0], p[1], p[2]);
            const float value = accessor.getValue(*c);
            if (expected > 0) {
                ASSERT_NEAR(value, std::min<double>(expected, background), 2e-5) << *c;
                ++compared;
            } else if (expected < -2e-7) {  // what floats of this size can tell from 0
                ASSERT_LT(value, 0) << *c;
                ASSERT_LE(value, expected + 2e-5) << *c;
            }
        }
        EXPECT_GT(compared, 10000U);
    }
}

TEST(Voxelizer, InsideTheValuesAreThoseOfThePlainLoopsWeldsIncluded) {
    const gcode::Toolpath toolpath = smallPrint();
    const test::PlainField plain(toolpath);
    for (const double voxel : {0.1, 0.05, 0.037, 0.33}) {
        const auto grid = voxelize(toolpath, allBeads(toolpath), latticeOf(voxel));
        const auto accessor = grid->getConstAccessor();
        openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
        box.expand(1);
        const double background = grid->background();
        std::size_t inside = 0;
        for (auto c = box.begin(); c; ++c) {
            if (voxel < 0.05 && ((*c)[0] + (*c)[1]) % 3 != 0) continue;
            const openvdb::Vec3d p = grid->indexToWorld(*c);
            const double expected = std::clamp(plain(p[0], p[1], p[2]), -background, background);
            ASSERT_NEAR(accessor.getValue(*c), expected, 2e-6) << *c << " at " << voxel;
            if (expected < 0) ++inside;
        }
        EXPECT_GT(inside, 100U);
    }
}

TEST(Voxelizer, APartialPrintIsTheSameHoweverItWasReached) {
    const gcode::Toolpath toolpath = smallPrint();
    const auto beads = allBeads(toolpath);
    for (const Interior interior : {Interior::keep, Interior::cull}) {
        VoxelizeOptions options;
        options.interior = interior;
        for (const double voxel : {0.1, 0.03}) {
            const Lattice lattice = latticeOf(voxel);
            Voxelizer series(toolpath, beads, lattice, options);
            for (const std::uint32_t end : {5U, 17U, 18U, 40U, 61U, 72U}) {
                const auto grown = series.printUntil(end);
                const std::vector<std::uint32_t> part(beads.begin(), beads.begin() + end);
                const auto fresh = voxelize(toolpath, part, lattice, options);
                test::expectSame(*fresh, *grown);
                // Steps that change little evaluate little.
                if (end == 18 && interior == Interior::keep) {
                    EXPECT_LT(series.report().leaves_evaluated, fresh->tree().leafCount());
                    EXPECT_GT(series.report().leaves_reused, 0U);
                }
            }
        }
    }
}

TEST(Voxelizer, UpYTurnsTheWorldAndNothingElse) {
    const gcode::Toolpath toolpath = smallPrint();
    VoxelizeOptions options;
    options.placement.up_y = true;
    options.placement.offset[1] = 2;
    const auto turned = voxelize(toolpath, allBeads(toolpath), latticeOf(0.1), options);
    const openvdb::Vec3d p = turned->indexToWorld(openvdb::Coord(10, 20, 5));
    EXPECT_EQ(p, openvdb::Vec3d(1.0, 0.5, -4.0));
    expectNothingWrong(*turned);
}

TEST(Voxelizer, IsALevelSetThatOpenVdbFindsNothingWrongWith) {
    const gcode::Toolpath toolpath = smallPrint();
    for (const double voxel : {0.1, 0.05, 0.02}) {
        const auto grid = voxelize(toolpath, allBeads(toolpath), latticeOf(voxel));
        expectNothingWrong(*grid);
        EXPECT_EQ(grid->getName(), "surface");
        EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
        EXPECT_NEAR(grid->background(), 3 * voxel, 4e-6 * voxel);
    }
}

TEST(Voxelizer, ASmoothBodyPassesEveryCheckOfOpenVdb) {
    // With beads many voxels thick and no crease, the ninth check holds as well.
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 4, 10, 0, 4, 6, 4);
    const auto grid = voxelize(toolpath, allBeads(toolpath), latticeOf(0.1));
    EXPECT_EQ(openvdb::tools::checkLevelSet(*grid), "");
}

TEST(Voxelizer, SignsAreCompleteAndTilesPruned) {
    // Twelve voxels a layer: the insides of beads are deeper than the band, so there are inside tiles and voxels.
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 4, 30, 0, 4, 20, 4);
    addBead(toolpath, 0, 0, 8, 30, 0, 8, 20, 4);
    const auto grid = voxelize(toolpath, allBeads(toolpath), latticeOf(0.1));
    const auto filled = grid->deepCopy();
    openvdb::tools::signedFloodFill(filled->tree());
    test::expectSame(*grid, *filled);
    EXPECT_LT(grid->getConstAccessor().getValue(openvdb::Coord(150, 0, 20)), 0);
    EXPECT_FALSE(grid->tree().isValueOn(openvdb::Coord(150, 0, 20)));
    EXPECT_EQ(grid->tree().probeConstLeaf(openvdb::Coord(150, 0, 20)), nullptr);
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) EXPECT_FALSE(leaf->isEmpty());
}

TEST(Voxelizer, OneThreadOrTwoTheSameVoxels) {
    const gcode::Toolpath toolpath = smallPrint();
    openvdb::FloatGrid::Ptr grids[2];
    for (std::size_t n = 0; n < 2; ++n) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n + 1);
        grids[n] = voxelize(toolpath, allBeads(toolpath), latticeOf(0.05));
    }
    test::expectSame(*grids[0], *grids[1]);
}

TEST(Voxelizer, WeldedFlatsLeaveNoCrack) {
    // Two wide flats that touch exactly on a voxel plane: unwelded, phi is 0 there.
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 4, 0, 0.2, 3, 0.2);
    addBead(toolpath, 0, 0, 0.4, 4, 0, 0.4, 3, 0.2);
    const auto grid = voxelize(toolpath, allBeads(toolpath), latticeOf(0.1));
    const auto accessor = grid->getConstAccessor();
    for (int i = 0; i <= 40; ++i)
        for (int j = -12; j <= 12; ++j)
            for (int k = 1; k <= 3; ++k) EXPECT_LT(accessor.getValue(openvdb::Coord(i, j, k)), -0.04f);
    // And the surface stays where it was.
    EXPECT_NEAR(accessor.getValue(openvdb::Coord(20, 0, 4)), 0, 1e-7);
    EXPECT_NEAR(accessor.getValue(openvdb::Coord(20, 0, 6)), 0.2, 1e-6);
}

TEST(Voxelizer, SpiralTurnsAreWelded) {
    gcode::Toolpath toolpath;
    for (int turn = 0; turn < 4; ++turn)
        addArc(toolpath, 0, 0, 5, 0, 2 * std::numbers::pi, 0.2 + 0.2 * turn, 0.4 + 0.2 * turn, 0.6, 0.2);
    const auto grid = voxelize(toolpath, allBeads(toolpath), latticeOf(0.05));
    const auto accessor = grid->getConstAccessor();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> angle(0.1, 2 * std::numbers::pi - 0.1);
    for (int n = 0; n < 2000; ++n) {
        const double a = angle(random);
        // Between the centre planes of two neighbouring turns, on the path: solid throughout.
        for (double rise = 0; rise <= 0.4; rise += 0.01) {
            const double z = 0.1 + 0.2 * a / (2 * std::numbers::pi) + rise + 0.03;
            const openvdb::Vec3d index = grid->worldToIndex(openvdb::Vec3d(5 * std::cos(a), 5 * std::sin(a), z));
            EXPECT_LT(accessor.getValue(openvdb::Coord::round(index)), 0) << a << " " << z;
        }
    }
    expectNothingWrong(*grid);
}

TEST(Voxelizer, PlacementMovesAndScalesTheWorldNotTheVoxels) {
    const gcode::Toolpath toolpath = smallPrint();
    const auto plain = voxelize(toolpath, allBeads(toolpath), latticeOf(0.1));
    VoxelizeOptions options;
    options.placement.unit = 0.001;
    options.placement.offset[0] = -3;
    options.placement.offset[2] = 1;
    const auto placed = voxelize(toolpath, allBeads(toolpath), latticeOf(0.1), options);
    EXPECT_TRUE(plain->tree().hasSameTopology(placed->tree()));
    const openvdb::Coord ijk(10, 20, 5);
    const openvdb::Vec3d world = placed->indexToWorld(ijk);
    EXPECT_NEAR(world[0], (1.0 - 3) * 0.001, 1e-12);
    EXPECT_NEAR(world[1], 2.0 * 0.001, 1e-12);
    EXPECT_NEAR(world[2], (0.5 + 1) * 0.001, 1e-12);
    EXPECT_NEAR(placed->getConstAccessor().getValue(ijk), plain->getConstAccessor().getValue(ijk) * 0.001, 1e-9);
    expectNothingWrong(*placed);
}

TEST(Voxelizer, FarFromTheOriginNothingIsLost) {
    gcode::Toolpath near;
    gcode::Toolpath far;
    addBead(near, 0, 0, 0.2, 3, 1, 0.2, 0.5, 0.2);
    addBead(far, 1000, 2000, 1000.2, 1003, 2001, 1000.2, 0.5, 0.2);
    const auto a = voxelize(near, allBeads(near), latticeOf(0.1));
    const auto b = voxelize(far, allBeads(far), latticeOf(0.1));
    const auto accessor = b->getConstAccessor();
    for (auto it = a->cbeginValueOn(); it; ++it)
        ASSERT_NEAR(accessor.getValue(it.getCoord().offsetBy(10000, 20000, 10000)), *it, 1e-6);
}

TEST(Voxelizer, RefusesWhatDoesNotFitWithTheEstimate) {
    const gcode::Toolpath toolpath = smallPrint();
    VoxelizeOptions options;
    options.memory_limit = std::size_t{2} << 20;
    try {
        voxelize(toolpath, allBeads(toolpath), latticeOf(0.02), options);
        FAIL() << "expected a refusal";
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("voxel size 0.02 mm needs about"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("2.1 MB are free"), std::string::npos) << error.what();
    }
}

// OpenVDB's copies of a topology do not survive a failed allocation.
TEST(Voxelizer, RefusesAttributesThatDoNotFit) {
    const gcode::Toolpath toolpath = smallPrint();
    const auto beads = allBeads(toolpath);
    const Lattice lattice = latticeOf(0.05);
    VoxelizeOptions options;
    options.interior = Interior::cull;  // whose leaves are not known before
    options.memory_limit = voxelize(toolpath, beads, lattice, options)->tree().leafCount() * 10000;
    Voxelizer voxelizer(toolpath, beads, lattice, options);
    (void)voxelizer.printAll();
    EXPECT_EQ(voxelizer.attributes(parseGrids("layer,color")).size(), 2U);
    EXPECT_THROW((void)voxelizer.attributes(parseGrids("layer,color,time")), UsageError);
}

}  // namespace
}  // namespace stratum::voxelize

// Prints that nobody slices and everybody gets one day: right values, or a clear refusal.
#include "base/error.h"
#include "plain_field.h"
#include "toolpaths.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Diagnostics.h>

#include <random>

namespace stratum::voxelize {
namespace {

using test::addBead;
using test::allBeads;

// Every voxel of random leaves against the plain loops in double.
void expectRight(const gcode::Toolpath& toolpath, const Lattice& lattice, std::size_t leaves = 60) {
    const auto grid = voxelize(toolpath, allBeads(toolpath), lattice);
    ASSERT_GT(grid->activeVoxelCount(), 0U);
    // OpenVDB's check wants three voxels of band.
    if (lattice.half_width >= 3) {
        EXPECT_EQ(openvdb::tools::checkLevelSet(*grid, 6), "");
    }
    const test::PlainField plain(toolpath);
    const double background = grid->background();
    // Floats of the size of the band, of a leaf, or of a bead's flats, whichever is largest.
    double size = std::max(background, 8 * lattice.voxel_size);
    for (const gcode::Bead& bead : toolpath.beads) size = std::max(size, static_cast<double>(bead.width) / 2);
    const double tolerance = 4e-7 * size + 2e-7;
    std::vector<const openvdb::FloatTree::LeafNodeType*> all;
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) all.push_back(leaf.getLeaf());
    std::mt19937 random(4);
    for (std::size_t n = 0; n < leaves; ++n) {
        const auto* leaf = all[random() % all.size()];
        for (openvdb::Index v = 0; v < 512; v += 3) {
            const openvdb::Vec3d p = grid->indexToWorld(leaf->offsetToGlobalCoord(v));
            const double expected = std::clamp(plain(p[0], p[1], p[2]), -background, background);
            ASSERT_NEAR(leaf->getValue(v), expected, tolerance) << p << " voxel " << lattice.voxel_size;
        }
    }
}

Lattice latticeOfHeight(double voxel, double height, double half_width = 3) {
    Lattice lattice;
    lattice.voxel_size = voxel;
    lattice.layer_height = height;
    lattice.half_width = half_width;
    return lattice;
}

TEST(Extremes, WidthsOfUpToAHundredHeights) {
    for (const double ratio : {1.0, 1.001, 2.0, 20.0, 100.0}) {
        SCOPED_TRACE(ratio);
        expectRight(study::crossedLines(0.2 * ratio, 0.2), latticeOfHeight(0.05, 0.2), 40);
    }
}

TEST(Extremes, LayersFromAHundredthOfAMillimetreToFive) {
    for (const double height : {0.01, 0.05, 1.0, 5.0}) {
        SCOPED_TRACE(height);
        expectRight(study::crossedLines(2 * height, height), latticeOfHeight(height / 3, height));
    }
}

TEST(Extremes, FromLessThanOneVoxelALayerToSixtyFour) {
    for (const double count : {0.6, 0.9, 1.0, 1.7, 16.0, 64.0}) {
        SCOPED_TRACE(count);
        expectRight(study::crossedLines(0.4, 0.2), latticeOfHeight(0.2 / count, 0.2), 40);
    }
}

TEST(Extremes, HalfWidthsFromOneToTen) {
    for (const double half_width : {1.0, 1.5, 3.0, 7.3, 10.0}) {
        SCOPED_TRACE(half_width);
        expectRight(study::crossedLines(0.45, 0.2), latticeOfHeight(0.04, 0.2, half_width), 40);
        VoxelizeOptions options;
        options.interior = Interior::cull;
        const gcode::Toolpath toolpath = study::crossedLines(0.45, 0.2);
        const auto culled = voxelize(toolpath, allBeads(toolpath), latticeOfHeight(0.04, 0.2, half_width), options);
        if (half_width >= 3) {
            EXPECT_EQ(openvdb::tools::checkLevelSet(*culled, 6), "");
        }
    }
}

TEST(Extremes, AMetreFromTheOrigin) {
    expectRight(study::crossedLines(0.45, 0.2, 1000, -1000, 1000), latticeOfHeight(0.05, 0.2));
}

TEST(Extremes, AThinAndAThickLayerSideBySide) {
    gcode::Toolpath toolpath = study::crossedLines(0.5, 0.2);
    addBead(toolpath, 0.2, 0, 1.5, 1, 0.1, 1.5, 2.0, 1.5, 9);
    addBead(toolpath, -1, 0, 0.05, 1, 0, 0.05, 0.3, 0.05, 9);
    expectRight(toolpath, latticeOfHeight(0.03, 0.2));
}

TEST(Extremes, OneBeadOfAMetre) {
    gcode::Toolpath toolpath;
    addBead(toolpath, -300, -400, 0.2, 300, 400, 0.2, 0.45, 0.2);
    expectRight(toolpath, latticeOfHeight(0.1, 0.2), 200);
}

TEST(Extremes, DuplicatesAndPointsAndHairpins) {
    gcode::Toolpath toolpath;
    for (int n = 0; n < 1000; ++n) addBead(toolpath, 0, 0, 0.2, 3, 1, 0.2, 0.45, 0.2);
    addBead(toolpath, 1, 2, 0.2, 1, 2, 0.2, 0.45, 0.2);
    addBead(toolpath, 0, 2, 0.2, 3, 2.001, 0.2, 0.45, 0.2);
    addBead(toolpath, 3, 2.001, 0.2, 0, 2.002, 0.2, 0.45, 0.2);
    expectRight(toolpath, latticeOfHeight(0.05, 0.2), 20);
}

// Too many beads for the plain loops: the shape that they make together is known.
TEST(Extremes, AMillionBeadsOfAMicrometreAreOneLine) {
    gcode::Toolpath many;
    for (int n = 0; n < 1000000; ++n) addBead(many, n * 1e-3 * 1e-3, 0, 0.2, (n + 1) * 1e-3 * 1e-3, 0, 0.2, 0.45, 0.2);
    gcode::Toolpath one;
    addBead(one, 0, 0, 0.2, 1, 0, 0.2, 0.45, 0.2);
    const auto a = voxelize(many, allBeads(many), latticeOfHeight(0.05, 0.2));
    const auto b = voxelize(one, allBeads(one), latticeOfHeight(0.05, 0.2));
    EXPECT_EQ(a->activeVoxelCount(), b->activeVoxelCount());
    const auto accessor = b->getConstAccessor();
    for (auto voxel = a->cbeginValueOn(); voxel; ++voxel)
        ASSERT_NEAR(*voxel, accessor.getValue(voxel.getCoord()), 1e-6);
}

TEST(Extremes, AMillionBeadsInOneLayerAreASheet) {
    // A thousand rows of a thousand short beads.
    gcode::Toolpath toolpath;
    for (int row = 0; row < 1000; ++row)
        for (int n = 0; n < 1000; ++n)
            addBead(toolpath, 0.1 * n, 0.1 * row, 0.2, 0.1 * (n + 1), 0.1 * row, 0.2, 0.45, 0.2);
    const auto grid = voxelize(toolpath, allBeads(toolpath), latticeOfHeight(0.1, 0.2));
    const auto accessor = grid->getConstAccessor();
    for (int k = -2; k <= 4; ++k)
        for (int i = 10; i < 990; i += 97)
            EXPECT_NEAR(accessor.getValue(openvdb::Coord(i, i / 2 + 100, k)), std::abs(0.1 * k - 0.1) - 0.1, 1e-6);
}

TEST(Extremes, BeadsInAnyOrderMakeTheSame) {
    const gcode::Toolpath ordered = study::crossedLines(0.45, 0.2);
    gcode::Toolpath reversed = ordered;
    std::reverse(reversed.beads.begin(), reversed.beads.end());
    const auto a = voxelize(ordered, allBeads(ordered), latticeOfHeight(0.05, 0.2));
    const auto b = voxelize(reversed, allBeads(reversed), latticeOfHeight(0.05, 0.2));
    EXPECT_EQ(a->activeVoxelCount(), b->activeVoxelCount());
    const auto accessor = b->getConstAccessor();
    for (auto voxel = a->cbeginValueOn(); voxel; ++voxel) ASSERT_EQ(*voxel, accessor.getValue(voxel.getCoord()));
}

TEST(Extremes, WhatCannotBeIsRefused) {
    gcode::Toolpath toolpath;
    addBead(toolpath, 0, 0, 0.2, 1000, 1000, 0.2, 0.45, 0.2);
    const auto beads = allBeads(toolpath);
    LatticeRequest request;
    for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e9, 1e-9}) {
        request.voxel_size = bad;
        EXPECT_THROW(chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request), UsageError) << bad;
    }
    request.voxel_size = 0.1;
    for (const double bad : {0.5, 11.0, -3.0}) {
        request.half_width = bad;
        EXPECT_THROW(chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request), UsageError) << bad;
    }
    EXPECT_THROW(voxelize(toolpath, beads, latticeOfHeight(1e-4, 0.2)), UsageError);
    // Voxels of 0.01 mm are 1e-5 m.
    VoxelizeOptions metres;
    metres.placement.unit = 0.001;
    gcode::Toolpath small;
    addBead(small, 0, 0, 0.2, 1, 0, 0.2, 0.45, 0.2);
    EXPECT_THROW(voxelize(small, allBeads(small), latticeOfHeight(0.01, 0.2), metres), UsageError);
}

}  // namespace
}  // namespace stratum::voxelize

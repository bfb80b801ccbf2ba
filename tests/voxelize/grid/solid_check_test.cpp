#include "voxelize/grid/solid_check.h"

#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <string>

namespace stratum::voxelize {
namespace {

using test::addArc;
using test::addBead;
using test::allBeads;

// A cube of crossing lines: each layer touches the ones below and above where they cross, and nowhere else.
gcode::Toolpath crossing(int layers, double spacing) {
    gcode::Toolpath toolpath;
    for (int layer = 0; layer < layers; ++layer)
        for (double at = 0.013; at <= 6; at += spacing) {
            const double z = 0.2 * (layer + 1);
            const auto number = static_cast<std::uint32_t>(layer + 1);
            if (layer % 2 == 0)
                addBead(toolpath, 0, at, z, 6, at, z, 0.45, 0.2, number);
            else
                addBead(toolpath, at, 0, z, at, 6, z, 0.45, 0.2, number);
        }
    return toolpath;
}

Lattice chosen(const gcode::Toolpath& toolpath, const LatticeRequest& request) {
    const auto beads = allBeads(toolpath);
    return chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
}

LatticeRequest perLayer(int count) {
    LatticeRequest request;
    request.voxels_per_layer = count;
    return request;
}

double enclosedShare(const gcode::Toolpath& toolpath, const Lattice& lattice) {
    openvdb::initialize();
    const auto beads = allBeads(toolpath);
    return enclosedVolume(*voxelize(toolpath, beads, lattice)) / depositedVolume(toolpath, beads);
}

TEST(SolidCheck, OneVoxelALayerOnTheLayersPlanesLosesBeads) {
    const gcode::Toolpath toolpath = crossing(8, 2);
    Lattice lattice = chosen(toolpath, perLayer(1));
    lattice.origin_z = 0;
    EXPECT_GT(lostShare(toolpath, allBeads(toolpath), lattice), 0.9);
    EXPECT_LT(enclosedShare(toolpath, lattice), 0.2);
}

TEST(SolidCheck, HalfAVoxelOffOneALayerLosesNone) {
    const gcode::Toolpath toolpath = crossing(8, 2);
    const Lattice lattice = chosen(toolpath, perLayer(1));
    EXPECT_NEAR(lattice.origin_z, 0.1, 1e-12);
    EXPECT_NE(lattice.reason.find("half a voxel"), std::string::npos);
    EXPECT_EQ(lostShare(toolpath, allBeads(toolpath), lattice), 0);
    EXPECT_NEAR(enclosedShare(toolpath, lattice), 1, kVolumeDoubt);
}

TEST(SolidCheck, VoxelsLargerThanALayerAreToldFromLarge) {
    const gcode::Toolpath toolpath = crossing(8, 2);
    LatticeRequest request;
    request.voxel_size = 0.5;
    const double lost = lostShare(toolpath, allBeads(toolpath), chosen(toolpath, request));
    EXPECT_GT(lost, 0.2);
    request.voxel_size = 0.2;
    EXPECT_EQ(lostShare(toolpath, allBeads(toolpath), chosen(toolpath, request)), 0);
}

TEST(SolidCheck, TwoVoxelsALayerLoseNone) {
    const gcode::Toolpath toolpath = crossing(8, 2);
    for (const int count : {2, 3, 4}) {
        const Lattice lattice = chosen(toolpath, perLayer(count));
        EXPECT_EQ(lattice.origin_z, 0) << count;
        EXPECT_EQ(lostShare(toolpath, allBeads(toolpath), lattice), 0) << count;
        EXPECT_NEAR(enclosedShare(toolpath, lattice), 1, kVolumeDoubt) << count;
    }
}

// The share is what the grid itself says at the beads' middles.
TEST(SolidCheck, TheShareIsTheGrids) {
    openvdb::initialize();
    gcode::Toolpath toolpath = crossing(6, 1.3);
    addArc(toolpath, 12, 3, 2.5, 0.3, 4, 0.2, 0.2, 0.45, 0.2);
    addBead(toolpath, 10, 10, 0.7, 13, 10, 0.9, 0.4, 0.2);
    const auto beads = allBeads(toolpath);
    ASSERT_LT(beads.size(), 500U);
    for (const double size : {0.11, 0.2, 0.3, 0.4, 0.7}) {
        LatticeRequest request;
        request.voxel_size = size;
        const Lattice lattice = chosen(toolpath, request);
        const auto grid = voxelize(toolpath, beads, lattice);
        const auto accessor = grid->getConstAccessor();
        int lost = 0;
        for (const std::uint32_t index : beads) {
            const gcode::Bead& bead = toolpath.beads[index];
            double x = 0.5 * (bead.x0 + bead.x1);
            double y = 0.5 * (bead.y0 + bead.y1);
            if (bead.arc >= 0) x = 12 + 2.5 * std::cos(2.3), y = 3 + 2.5 * std::sin(2.3);
            const double z = 0.5 * (bead.z0 + bead.z1) - 0.1;
            lost += openvdb::tools::BoxSampler::sample(accessor, grid->worldToIndex({x, y, z})) >= 0 ? 1 : 0;
        }
        EXPECT_NEAR(lostShare(toolpath, beads, lattice), static_cast<double>(lost) / static_cast<double>(beads.size()),
                    0.05)
            << size;
    }
}

TEST(SolidCheck, SampledVolumeIsTheVolume) {
    openvdb::initialize();
    const gcode::Toolpath toolpath = crossing(8, 0.41);
    const auto grid = voxelize(toolpath, allBeads(toolpath), chosen(toolpath, perLayer(8)));
    ASSERT_GT(grid->tree().leafCount(), 4000U);
    const double all = enclosedVolume(*grid);
    EXPECT_NEAR(enclosedVolume(*grid, 2000), all, 0.04 * all);
    EXPECT_EQ(enclosedVolume(*grid, grid->tree().leafCount()), all);
}

}  // namespace
}  // namespace stratum::voxelize

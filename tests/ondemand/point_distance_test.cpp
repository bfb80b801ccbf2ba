#include "ondemand/point_distance.h"

#include "base/error.h"
#include "base/input_file.h"
#include "corpus.h"
#include "deposit/read_print.h"
#include "ondemand/print_field.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

namespace stratum::ondemand {
namespace {

struct SampledPrint {
    std::shared_ptr<const gcode::Toolpath> toolpath;
    std::vector<std::uint32_t> selection;
    voxelize::Lattice lattice;
};

SampledPrint sampledPrint(const char* name, const char* layers, int per_layer,
                          const gcode::DepositModel& deposit = {}) {
    const InputFile file(test::dataDir() / "gcode" / name);
    gcode::ReadOptions options;
    options.deposit = deposit;
    SampledPrint print;
    print.toolpath =
        std::make_shared<const gcode::Toolpath>(deposit::readPrint(file.bytes(), name, options, false).toolpath);
    voxelize::Selection selection;
    voxelize::parseLayers(layers, selection);
    print.selection = voxelize::selectBeads(*print.toolpath, selection);
    voxelize::LatticeRequest request;
    request.voxels_per_layer = per_layer;
    print.lattice = voxelize::chooseLattice(*print.toolpath, print.selection,
                                            voxelize::boundsOf(*print.toolpath, print.selection), request);
    return print;
}

// At every sample within reach the value of the grid, which has the precision of floats.
void expectSameAsGrid(const SampledPrint& print) {
    const auto grid = voxelize::voxelize(*print.toolpath, print.selection, print.lattice);
    const PrintLayout layout(print.toolpath, print.selection, print.lattice, 1);
    const PointDistance distance(layout);
    std::size_t near = 0;
    std::size_t inside = 0;
    std::size_t number = 0;
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
        if (++number % 37 != 0) continue;
        const openvdb::Vec3d place = grid->indexToWorld(voxel.getCoord());
        const double exact = distance.at({place[0], place[1], place[2]});
        if (*voxel >= static_cast<float>(distance.reach())) {
            EXPECT_NEAR(exact, distance.reach(), 1e-5);
            continue;
        }
        ++near;
        inside += exact < 0 ? 1 : 0;
        ASSERT_NEAR(exact, *voxel, 3e-6) << voxel.getCoord();
    }
    EXPECT_GT(near, 1000U);
    EXPECT_GT(inside, 100U);
}

TEST(PointDistance, IsTheGridsValueAtItsSamples) {
    expectSameAsGrid(sampledPrint("hull.gcode", "1:10", 3));
    expectSameAsGrid(sampledPrint("tile_arcs.gcode", "1:", 2));
}

TEST(PointDistance, OfSlopedAndWideningBeads) {
    gcode::DepositModel deposit;
    deposit.flow_lag = 0.05;
    deposit.sag = 0.03;
    deposit.corner_fraction = 0.5;
    expectSameAsGrid(sampledPrint("bridges.gcode", "1:12", 3, deposit));
    expectSameAsGrid(sampledPrint("vase.gcode", "1:20", 2));
}

// On the planes between layers, where two flats touch.
TEST(PointDistance, IsNegativeInsideWelds) {
    const SampledPrint print = sampledPrint("hull.gcode", "2:6", 2);
    const PrintLayout layout(print.toolpath, print.selection, print.lattice, 1);
    ASSERT_GT(layout.stack.welds.size(), 2U);
    const PointDistance distance(layout);
    std::size_t covered = 0;
    for (const std::uint32_t index : print.selection) {
        const gcode::Bead& bead = print.toolpath->beads[index];
        const glm::dvec3 above(0.5 * (bead.x0 + bead.x1), 0.5 * (bead.y0 + bead.y1), bead.z0 + 0.05);
        // The flat of another bead lies on it, there, whose center is 0.1 mm above.
        if (distance.at(above) >= -0.05 + 1e-9) continue;
        ++covered;
        for (const double up : {-1e-3, 0.0, 1e-9, 1e-3})
            ASSERT_LT(distance.at({above.x, above.y, bead.z0 + up}), 0) << index << " " << up;
    }
    EXPECT_GT(covered, 100U);
}

TEST(PointDistance, FarAway) {
    const SampledPrint print = sampledPrint("tile.gcode", "1:", 2);
    const PrintLayout layout(print.toolpath, print.selection, print.lattice, 1);
    const PointDistance distance(layout);
    for (const double far : {1e3, 1e12, 1e300, -1e300}) {
        EXPECT_EQ(distance.at({far, 0, 0}), distance.reach());
        EXPECT_EQ(distance.at({0, far, 0}), distance.reach());
        EXPECT_EQ(distance.at({100, 100, far}), distance.reach());
    }
}

TEST(PointDistance, RefusesSettledBeads) {
    gcode::DepositModel deposit;
    deposit.beads = gcode::DepositModel::Beads::settled;
    const SampledPrint print = sampledPrint("tile.gcode", "1:3", 2, deposit);
    const PrintLayout layout(print.toolpath, print.selection, print.lattice, 1);
    EXPECT_THROW(PointDistance{layout}, UsageError);
}

}  // namespace
}  // namespace stratum::ondemand

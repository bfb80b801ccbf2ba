#include "voxelize/swell/swell_field.h"

#include "same_grids.h"
#include "toolpaths.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/deposit_balance.h"
#include "voxelize/grid/enclosed_volume.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {
namespace {

using gcode::DepositModel;

constexpr double kWidth = 0.45;
constexpr double kHeight = 0.2;

// A frame with sparse infill, whose lines end 0.15 mm within the wall.
gcode::Toolpath sparse(double angle = 0.6) {
    gcode::Toolpath toolpath;
    constexpr double kHalf = 4;
    const double corners[5][2] = {{-kHalf, -kHalf}, {kHalf, -kHalf}, {kHalf, kHalf}, {-kHalf, kHalf}, {-kHalf, -kHalf}};
    for (int layer = 1; layer <= 2; ++layer) {
        const auto number = static_cast<std::uint32_t>(layer);
        const double z = layer * kHeight;
        for (int n = 0; n < 4; ++n)
            test::addBead(toolpath, corners[n][0], corners[n][1], z, corners[n + 1][0], corners[n + 1][1], z, kWidth,
                          kHeight, number);
        const double inner = kHalf - 0.5 * kWidth + 0.15;
        for (double offset = -4.5; offset <= 4.5; offset += 1.5) {
            // The part of the line at this offset within the square.
            double from = -10;
            double to = 10;
            const double ux = std::cos(angle);
            const double uy = std::sin(angle);
            for (const auto& [at, step] : {std::pair{-offset * uy, ux}, std::pair{offset * ux, uy}}) {
                from = std::max(from, std::min((-inner - at) / step, (inner - at) / step));
                to = std::min(to, std::max((-inner - at) / step, (inner - at) / step));
            }
            if (to - from > 0.5)
                test::addBead(toolpath, -offset * uy + from * ux, offset * ux + from * uy, z, -offset * uy + to * ux,
                              offset * ux + to * uy, z, kWidth, kHeight, number);
        }
    }
    return toolpath;
}

DepositBalance balanceOf(gcode::Toolpath& toolpath, DepositModel::Beads beads = DepositModel::Beads::settled) {
    toolpath.deposit.beads = beads;
    return balanceDeposit(toolpath, stackLayers(toolpath, test::allBeads(toolpath)), 0xffffffff);
}

TEST(SwellField, InfillThatEndsInAWallLosesNothing) {
    for (const double angle : {0.6, 0.0, 1.2}) {
        gcode::Toolpath toolpath = sparse(angle);
        const DepositBalance grooves = balanceOf(toolpath, DepositModel::Beads::grooves);
        EXPECT_GT(grooves.unplaced(), 0.008 * grooves.all.fed) << "nothing to place at " << angle;
        EXPECT_EQ(grooves.pressed_out, 0);
        const DepositBalance balance = balanceOf(toolpath);
        EXPECT_NEAR(balance.held(), balance.all.fed, 3e-3 * balance.all.fed) << angle;
        EXPECT_EQ(balance.all.laid, grooves.all.laid);
    }
}

TEST(SwellField, TheGridHoldsWhatTheBalanceSays) {
    gcode::Toolpath toolpath = sparse();
    const DepositBalance balance = balanceOf(toolpath);
    const auto beads = test::allBeads(toolpath);
    LatticeRequest request;
    request.voxel_size = 0.02;
    const Lattice lattice = chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
    const auto grid = Voxelizer(toolpath, beads, lattice).printAll();
    EXPECT_NEAR(enclosedVolume(*grid), balance.held(), 4e-3 * balance.all.fed);
}

TEST(SwellField, SamplesAreThoseOfGroovesLessTheSwell) {
    gcode::Toolpath toolpath = sparse();
    const auto beads = test::allBeads(toolpath);
    LatticeRequest request;
    request.voxel_size = 0.05;
    const Lattice lattice = chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
    toolpath.deposit.beads = DepositModel::Beads::grooves;
    const auto before = Voxelizer(toolpath, beads, lattice).printAll();
    toolpath.deposit.beads = DepositModel::Beads::settled;
    const auto after = Voxelizer(toolpath, beads, lattice).printAll();
    const LayerStack stack = stackLayers(toolpath, beads);
    const auto old = before->getConstAccessor();
    int moved = 0;
    // On the center plane of the upper layer, outside: values are plan distances less the radius.
    const int k = static_cast<int>(std::lround((stack.layers[1].center_z - lattice.origin_z) / lattice.voxel_size));
    for (auto value = after->cbeginValueOn(); value; ++value) {
        const openvdb::Coord at = value.getCoord();
        if (at.z() != k || *value < 0 || !old.isValueOn(at)) continue;
        const double out =
            stack.swell->at(toolpath, stack, 1, at.x() * lattice.voxel_size, at.y() * lattice.voxel_size);
        ASSERT_NEAR(*value, old.getValue(at) - out, 2e-6) << at;
        moved += out > 1e-4;
    }
    EXPECT_GT(moved, 100);
}

TEST(SwellField, IsBoundedAndGentle) {
    // One line three times on itself, and lines that cross in one layer.
    gcode::Toolpath toolpath = sparse();
    for (int n = 0; n < 3; ++n) test::addBead(toolpath, -3, 0, kHeight, 3, 0.1, kHeight, kWidth, kHeight);
    const DepositBalance balance = balanceOf(toolpath);
    EXPECT_GT(balance.unplaced(), 0);
    EXPECT_LT(balance.held(), balance.all.fed);
    const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
    double most = 0;
    double steepest = 0;
    constexpr double kStep = 0.01;
    for (double y = -5; y < 5; y += 0.07)
        for (double x = -5; x < 5; x += 0.07) {
            const auto at = [&](double px, double py) { return stack.swell->at(toolpath, stack, 0, px, py); };
            most = std::max(most, at(x, y));
            steepest = std::max(steepest, std::hypot(at(x + kStep, y) - at(x, y), at(x, y + kStep) - at(x, y)) / kStep);
        }
    EXPECT_NEAR(most, kMostSwell, 1e-6);
    EXPECT_LE(steepest, std::sqrt(2.0) * kMostSwell / kNodeSpacing * (1 + 1e-3));
}

TEST(SwellField, DoesNotDependOnTheOrderOfItsTiles) {
    gcode::Toolpath toolpath = sparse();
    toolpath.deposit.beads = DepositModel::Beads::settled;
    const LayerStack one = stackLayers(toolpath, test::allBeads(toolpath));
    const LayerStack other = stackLayers(toolpath, test::allBeads(toolpath));
    for (int n = -2; n <= 2; ++n)
        for (int m = -2; m <= 2; ++m) one.swell->tile(toolpath, one, n, m);
    for (int n = 2; n >= -2; --n)
        for (int m = 2; m >= -2; --m) {
            const SwellTile* a = one.swell->tile(toolpath, one, m, n);
            const SwellTile* b = other.swell->tile(toolpath, other, m, n);
            ASSERT_EQ(a == nullptr, b == nullptr);
            if (a == nullptr) continue;
            EXPECT_EQ(a->layers, b->layers);
            EXPECT_EQ(a->swell, b->swell);
        }
}

}  // namespace
}  // namespace stratum::voxelize

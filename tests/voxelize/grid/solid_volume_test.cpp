// Volumes of all beads together against closed forms and against fine level sets.
#include "toolpaths.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/deposit_balance.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::voxelize {
namespace {

constexpr double kBeadWidth = 0.45;

double volumeOf(const gcode::Toolpath& toolpath) {
    return solidVolume(toolpath, stackLayers(toolpath, test::allBeads(toolpath)), 0xffffffff);
}
double levelSetVolumeOf(const gcode::Toolpath& toolpath, double voxel) {
    const auto beads = test::allBeads(toolpath);
    LatticeRequest request;
    request.voxel_size = voxel;
    const Lattice lattice = chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
    return enclosedVolume(*Voxelizer(toolpath, beads, lattice).printAll());
}

TEST(SolidVolume, OfABeadIsItsSectionAndTwoHalfDiscs) {
    constexpr double kHeight = 0.2;
    constexpr double kRadius = kHeight / 2;
    constexpr double kFlat = kBeadWidth / 2 - kRadius;
    gcode::Toolpath toolpath;
    test::addBead(toolpath, 0.3, 0.1, kHeight, 12.1, 4.7, kHeight, kBeadWidth, kHeight);
    const double ends = std::numbers::pi * (kFlat * kFlat * 2 * kRadius + std::numbers::pi * kFlat * kRadius * kRadius +
                                            4 * kRadius * kRadius * kRadius / 3);
    const double expected = gcode::beadVolume(toolpath) + ends;
    EXPECT_NEAR(volumeOf(toolpath), expected, 1e-3 * expected);
}

// Under a bridge's thick line that lies on a layer, and where a layer's lines cross: once.
TEST(SolidVolume, CountsWhatBeadsShareOnce) {
    gcode::Toolpath toolpath;
    for (double y = 0; y < 3; y += 0.407) test::addBead(toolpath, 0, y, 0.2, 6, y, 0.2, kBeadWidth, 0.2);
    test::addBead(toolpath, 1, -0.5, 0.4, 4, 3.5, 0.4, 0.5, 0.4, 2);
    test::addBead(toolpath, 5, 0, 0.3, 5.2, 3, 0.3, kBeadWidth, 0.2, 2);
    const double whole = levelSetVolumeOf(toolpath, 0.0125);
    EXPECT_NEAR(volumeOf(toolpath), whole, 3e-3 * whole);
    EXPECT_LT(volumeOf(toolpath), 0.97 * gcode::beadVolume(toolpath));
}

TEST(SolidVolume, IsThatOfTheSettledLevelSet) {
    gcode::Toolpath toolpath;
    for (int layer = 1; layer <= 2; ++layer)
        for (double y = 0; y < 4; y += 0.39)
            test::addBead(toolpath, 0, y, 0.2 * layer, 5, y, 0.2 * layer, kBeadWidth, 0.2,
                          static_cast<std::uint32_t>(layer));
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    toolpath.deposit.crown = 0.2;
    const double whole = levelSetVolumeOf(toolpath, 0.02);
    EXPECT_NEAR(volumeOf(toolpath), whole, 4e-3 * whole);
    const DepositBalance balance =
        balanceDeposit(toolpath, stackLayers(toolpath, test::allBeads(toolpath)), 0xffffffff);
    EXPECT_NEAR(volumeOf(toolpath), balance.held(), 2e-3 * balance.held());
}

TEST(SolidVolume, OfASteepLineIsACapsule) {
    gcode::Toolpath toolpath;
    test::addBead(toolpath, 0.3, 0.1, 1, 2.1, 1.2, 6, kBeadWidth, 0.2);
    const double radius = BeadField(toolpath, toolpath.beads[0]).radius();
    const double length = std::hypot(1.8, 1.1, 5);
    const double expected = std::numbers::pi * radius * radius * (length + 4 * radius / 3);
    EXPECT_NEAR(volumeOf(toolpath), expected, 5e-3 * expected);
}

// A thread that hangs between two blocks of layers, whose ends lie in them.
TEST(SolidVolume, CountsEndsOfSlopedBeadsInLayersOnce) {
    gcode::Toolpath toolpath;
    for (const double x : {0.0, 9.0})
        for (int layer = 1; layer <= 4; ++layer)
            for (double y = 0; y < 2; y += 0.407)
                test::addBead(toolpath, x, y, 0.2 * layer, x + 2, y, 0.2 * layer, kBeadWidth, 0.2,
                              static_cast<std::uint32_t>(layer));
    test::addBead(toolpath, 0.2, 0.9, 0.8, 5.5, 1, 0.5, kBeadWidth, 0.3, 4);
    test::addBead(toolpath, 5.5, 1, 0.5, 10.8, 0.9, 0.8, kBeadWidth, 0.3, 4);
    const double whole = levelSetVolumeOf(toolpath, 0.0125);
    EXPECT_NEAR(volumeOf(toolpath), whole, 3e-3 * whole);
    const DepositBalance balance =
        balanceDeposit(toolpath, stackLayers(toolpath, test::allBeads(toolpath)), 0xffffffff);
    EXPECT_NEAR(balance.held(), volumeOf(toolpath), 1e-6 * whole);
    EXPECT_GT(balance.shared, 0.2);
}

// Turns of a spiral overlap by what welds them.
TEST(SolidVolume, OfASpiral) {
    gcode::Toolpath toolpath;
    constexpr int kSides = 40;
    const auto corner = [](int n) { return 2 * std::numbers::pi * n / kSides; };
    for (int n = 0; n < 4 * kSides; ++n)
        test::addBead(toolpath, 5 * std::cos(corner(n)), 5 * std::sin(corner(n)), 0.2 + 0.2 * n / kSides,
                      5 * std::cos(corner(n + 1)), 5 * std::sin(corner(n + 1)), 0.2 + 0.2 * (n + 1) / kSides,
                      kBeadWidth, 0.2);
    const double whole = levelSetVolumeOf(toolpath, 0.0125);
    EXPECT_NEAR(volumeOf(toolpath), whole, 3e-3 * whole);
}

}  // namespace
}  // namespace stratum::voxelize

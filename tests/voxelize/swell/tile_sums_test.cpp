#include "voxelize/swell/tile_sums.h"

#include "toolpaths.h"
#include "voxelize/beads/layer_stack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::voxelize {
namespace {

constexpr double kLineWidth = 0.45;
constexpr double kLineHeight = 0.2;

struct Totals {
    double surplus = 0, gain = 0;
};
Totals totalsOf(gcode::Toolpath& toolpath) {
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
    const PlanBins bins(toolpath, stack, cellLattice(1), std::numeric_limits<std::size_t>::max());
    Totals totals;
    const LayerNeeds needs(stack);
    for (int y = -8; y <= 8; ++y)
        for (int x = -8; x <= 8; ++x) {
            const TileSums tile = sumTile(toolpath, stack, needs, bins, {x, y, 0});
            for (const auto& layer : tile.layers) {
                if (layer == nullptr) continue;
                for (const TileSums::Node& node : layer->nodes) {
                    totals.surplus += static_cast<double>(node.surplus);
                    totals.gain += static_cast<double>(node.gain.back());
                }
            }
        }
    return totals;
}

// The half discs at both ends of a bead, together: the solid of revolution of its section.
double endsOf(double half_flat, double radius) {
    return std::numbers::pi * (half_flat * half_flat * 2 * radius + std::numbers::pi * half_flat * radius * radius +
                               4 * radius * radius * radius / 3);
}

TEST(TileSums, ALoneLineLacksNothingButItsEnds) {
    for (const double angle : {0.0, 0.3, std::numbers::pi / 4, std::numbers::pi / 2}) {
        gcode::Toolpath toolpath;
        test::addBead(toolpath, -7.1, 0.13, kLineHeight, -7.1 + 14 * std::cos(angle), 0.13 + 14 * std::sin(angle),
                      kLineHeight, kLineWidth, kLineHeight);
        const Totals totals = totalsOf(toolpath);
        const double radius = kLineHeight / 2;
        const double fed = gcode::beadVolume(toolpath);
        EXPECT_NEAR(totals.surplus, -endsOf(kLineWidth / 2 - radius, radius), 4e-3 * fed) << angle;
        // All around it a strip kMostSwell wide is filled up.
        const double around = 2 * 14 * kMostSwell * kLineHeight;
        EXPECT_NEAR(totals.gain, around, 0.1 * around) << angle;
    }
}

TEST(TileSums, LinesThatCrossHaveTheSurplusOfTheirCrossing) {
    gcode::Toolpath toolpath;
    test::addBead(toolpath, -6, 0.1, kLineHeight, 6, 0.1, kLineHeight, kLineWidth, kLineHeight);
    const double one = totalsOf(toolpath).surplus;
    test::addBead(toolpath, 0.2, -6, kLineHeight, 0.2, 6, kLineHeight, kLineWidth, kLineHeight);
    const double crossing = totalsOf(toolpath).surplus - 2 * one;
    // The flats at least, and at most the rectangle of both widths.
    EXPECT_GT(crossing, std::pow(kLineWidth - kLineHeight, 2) * kLineHeight);
    EXPECT_LT(crossing, kLineWidth * kLineWidth * kLineHeight);
}

}  // namespace
}  // namespace stratum::voxelize

#include "voxelize/swell/swell_field.h"

#include "same_grids.h"
#include "toolpaths.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/deposit_balance.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

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

// All lengths `factor` times as large.
gcode::Toolpath enlarged(gcode::Toolpath toolpath, float factor) {
    for (gcode::Bead& bead : toolpath.beads) {
        for (auto* const plan : {&bead.x0, &bead.y0, &bead.x1, &bead.y1}) *plan = factor * *plan;
        for (auto* const z : {&bead.z0, &bead.z1}) *z = factor * *z;
        bead.width *= factor;
    }
    for (gcode::Run& run : toolpath.runs) run.height *= factor;
    return toolpath;
}

TEST(SwellField, APrintTenTimesAsLargeSettlesAlike) {
    gcode::Toolpath usual = enlarged(sparse(), 2);  // layers of 0.4 mm
    gcode::Toolpath large = enlarged(usual, 10);
    EXPECT_EQ(settlingScale(sparse()), 1);
    EXPECT_NEAR(settlingScale(usual), 1, 1e-6);
    EXPECT_NEAR(settlingScale(large), 10, 1e-5);
    const DepositBalance balance = balanceOf(usual);
    const DepositBalance of_large = balanceOf(large);
    EXPECT_GT(balance.pressed_out, 0.002 * balance.all.fed);
    EXPECT_NEAR(of_large.pressed_out / 1000, balance.pressed_out, 1e-4 * balance.all.fed);
    EXPECT_NEAR(of_large.raised / 1000, balance.raised, 1e-4 * balance.all.fed);
    EXPECT_NEAR(of_large.held() / 1000, balance.held(), 1e-4 * balance.all.fed);
    const LayerStack stack = stackLayers(usual, test::allBeads(usual));
    const LayerStack of_stack = stackLayers(large, test::allBeads(large));
    double most = 0;
    for (double x = -9; x <= 9; x += 0.37)
        for (double y = -9; y <= 9; y += 0.41)
            for (const std::uint32_t layer : {0U, 1U}) {
                const Swell at = stack.swell->at(usual, stack, layer, x, y);
                const Swell in_large = of_stack.swell->at(large, of_stack, layer, 10 * x, 10 * y);
                EXPECT_NEAR(in_large.out, 10 * at.out, 2e-3) << x << ' ' << y;
                EXPECT_NEAR(in_large.rise, 10 * at.rise, 2e-3) << x << ' ' << y;
                most = std::max(most, at.out);
            }
    EXPECT_GT(most, 0.02);
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
            stack.swell->at(toolpath, stack, 1, at.x() * lattice.voxel_size, at.y() * lattice.voxel_size).out;
        ASSERT_NEAR(*value, old.getValue(at) - out, 2e-6) << at;
        moved += out > 1e-4;
    }
    EXPECT_GT(moved, 100);
}

// Lines of 20 mm in layers of crossing directions, at a multiple of the slicers' spacing.
gcode::Toolpath solid(double spacing, int layers, double shift = 0.013) {
    constexpr int kLines = 24;
    const double step = spacing * (kWidth - kHeight * (1 - 0.25 * std::numbers::pi));
    gcode::Toolpath toolpath;
    for (int layer = 1; layer <= layers; ++layer)
        for (int n = 0; n < kLines; ++n) {
            const double at = (n - 0.5 * (kLines - 1)) * step + shift;
            const double z = layer * kHeight;
            const double half = 0.5 * kLines * step;
            if (layer % 2 == 0)
                test::addBead(toolpath, at, -half, z, at, half, z, kWidth, kHeight, static_cast<std::uint32_t>(layer));
            else
                test::addBead(toolpath, -half, at, z, half, at, z, kWidth, kHeight, static_cast<std::uint32_t>(layer));
        }
    return toolpath;
}

// The half discs at both ends of each bead: what it holds without having been fed.
double endDiscs(const gcode::Toolpath& toolpath) {
    constexpr double kRadius = kHeight / 2;
    constexpr double kFlat = kWidth / 2 - kRadius;
    return static_cast<double>(toolpath.beads.size()) * std::numbers::pi *
           (kFlat * kFlat * 2 * kRadius + std::numbers::pi * kFlat * kRadius * kRadius +
            4 * kRadius * kRadius * kRadius / 3);
}

TEST(SwellField, TwoLayersHoldWhatTheyWereFedAtEverySpacing) {
    for (const double spacing : {0.8, 0.85, 0.9, 0.94, 0.97, 1.0, 1.05, 1.1, 1.25, 1.5}) {
        gcode::Toolpath toolpath = solid(spacing, 2);
        const DepositBalance balance = balanceOf(toolpath);
        std::printf("  %.2f: fed %.3f, ends %.3f, grooves hold %.3f, out %.3f, up %.3f, no place %.3f mm3\n", spacing,
                    balance.all.fed, endDiscs(toolpath), balance.all.laid, balance.pressed_out, balance.raised,
                    balance.unplaced());
        // At 0.8 a quarter more is fed than the layers have room for: not all of it stands below kMostRise.
        EXPECT_LT(balance.unplaced(), (spacing < 0.85 ? 8e-3 : 2e-3) * balance.all.fed) << spacing;
        EXPECT_GT(balance.unplaced() + endDiscs(toolpath), -2e-3 * balance.all.fed) << spacing;
    }
}

// A square of three walls, filled by a zigzag at 45 degrees that overlaps the innermost wall by a quarter of a width,
// in three layers; `flow` multiplies the area of all beads.
gcode::Toolpath cube(double flow) {
    constexpr double kHalf = 8;
    const double width = kWidth + (flow - 1) * gcode::sectionArea(kWidth, kHeight) / kHeight;
    const double step = kWidth - kHeight * (1 - 0.25 * std::numbers::pi);
    const double diagonal = std::sqrt(0.5);
    gcode::Toolpath toolpath;
    for (int layer = 1; layer <= 3; ++layer) {
        const auto number = static_cast<std::uint32_t>(layer);
        const double z = layer * kHeight;
        const auto add = [&](double x0, double y0, double x1, double y1) {
            test::addBead(toolpath, x0, y0, z, x1, y1, z, width, kHeight, number);
        };
        for (int wall = 0; wall < 3; ++wall) {
            const double at = kHalf - wall * step;
            add(-at, -at, at, -at);
            add(at, -at, at, at);
            add(at, at, -at, at);
            add(-at, at, -at, -at);
        }
        const double inner = kHalf - 3 * step + 0.25 * kWidth;
        const double turn = layer % 2 == 0 ? 1 : -1;
        int line = 0;
        double last[2] = {};
        for (double across = 0.5 * step - 2 * inner; across < 2 * inner; across += step) {
            // Of the line x + y = sqrt(2) across, the part within the square.
            const double sum = across / diagonal;
            const double low = std::max(-inner, sum - inner);
            const double high = std::min(inner, sum + inner);
            if (high - low < 0.5) continue;
            const double from = line % 2 == 0 ? low : high;
            const double to = line % 2 == 0 ? high : low;
            if (line++ > 0) add(last[0], last[1], from, turn * (sum - from));
            add(from, turn * (sum - from), to, turn * (sum - to));
            last[0] = to;
            last[1] = turn * (sum - to);
        }
    }
    return toolpath;
}

// What photographs of extrusion tests show: gaps at 0.9, a seam that stands up at 1, ridges at 1.05 and more.
TEST(SwellField, TheSeamOfInfillAndWallRisesWithTheFlow) {
    double before = -1;
    for (const double flow : {0.9, 0.95, 1.0, 1.05, 1.1}) {
        gcode::Toolpath toolpath = cube(flow);
        toolpath.deposit.beads = DepositModel::Beads::settled;
        const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
        double sum = 0;
        int count = 0;
        for (double along = -5; along < 5; along += 0.05)
            for (double in = 6.3; in < 7.0; in += 0.05)
                for (const auto& [x, y] : {std::pair{along, in}, {along, -in}, {in, along}, {-in, along}}) {
                    sum += stack.swell->at(toolpath, stack, 2, x, y).rise;
                    ++count;
                }
        const double mean = 1e3 * sum / count;
        std::printf("  flow %.2f: the seam stands %.1f um high\n", flow, mean);
        EXPECT_GT(mean, before) << flow;
        if (flow == 1) {
            EXPECT_GT(mean, 5);
            EXPECT_LT(mean, 40);
        }
        before = mean;
    }
}

// Crowns take nothing from the volume, and stand on tops alone.
TEST(SwellField, CrownsKeepTheVolume) {
    for (const double spacing : {0.97, 1.0, 1.03}) {
        gcode::Toolpath toolpath = solid(spacing, 3);
        const DepositBalance flat = balanceOf(toolpath);
        toolpath.deposit.crown = 0.2;
        const DepositBalance crowned = balanceOf(toolpath);
        // What they take fills what ends of lines hold without having been fed, and raises the rest.
        EXPECT_GT(crowned.held(), crowned.all.fed * (1 - 1e-3)) << spacing;
        EXPECT_LT(crowned.held(), flat.held() * (1 + 1e-3)) << spacing;
        const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
        // Beside the middle of a line, and between two, away from the outlines.
        EXPECT_NEAR(stack.swell->at(toolpath, stack, 2, 0.1, 0.1).open, 1, 1e-6);
        EXPECT_EQ(stack.swell->at(toolpath, stack, 0, 0.1, 0.1).open, 0);
    }
}

// Roughness of the crowned top across its lines, from the level set: of published flat surfaces of PLA it is 7.8 um
// (Sci. Rep. s41598-025-26253-0, fig. 14) to 18 um (Int. J. Polymer Science 2023, 8844626, table 1, layers of 0.2 mm).
TEST(SwellField, CrownedTopsAreAsRoughAsPublishedOnes) {
    gcode::Toolpath toolpath = solid(1, 3);
    toolpath.deposit.beads = DepositModel::Beads::settled;
    toolpath.deposit.crown = 0.2;
    const auto beads = test::allBeads(toolpath);
    LatticeRequest request;
    request.voxel_size = 0.02;
    const Lattice lattice = chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
    const auto grid = Voxelizer(toolpath, beads, lattice).printAll();
    const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> field(*grid);
    // Heights of the top along y: lines of layer 3 lie along x.
    std::vector<double> heights;
    for (double y = -3; y < 3; y += 0.005) {
        double low = 2.5 * kHeight;
        double high = 3 * kHeight + 0.05;
        for (int n = 0; n < 30; ++n) {
            const double middle = 0.5 * (low + high);
            (field.wsSample(openvdb::Vec3d(0.7, y, middle)) < 0 ? low : high) = middle;
        }
        heights.push_back(low);
    }
    double mean = 0;
    for (const double height : heights) mean += height / static_cast<double>(heights.size());
    double ra = 0;
    for (const double height : heights) ra += std::abs(height - mean) / static_cast<double>(heights.size());
    std::printf("  Ra %.2f um, mean height %.2f um over the plane of the flats\n", 1e3 * ra,
                1e3 * (mean - 3 * kHeight));
    EXPECT_GT(ra, 6.8e-3);
    EXPECT_LT(ra, 18e-3);
    EXPECT_NEAR(mean, 3 * kHeight, 5e-4);
}

TEST(SwellField, IsBoundedAndGentle) {
    // One line twenty times on itself, and lines that cross in one layer.
    gcode::Toolpath toolpath = sparse();
    for (int n = 0; n < 20; ++n) test::addBead(toolpath, -3, 0, kHeight, 3, 0.1, kHeight, kWidth, kHeight);
    const DepositBalance balance = balanceOf(toolpath);
    EXPECT_GT(balance.unplaced(), 0);
    EXPECT_LT(balance.held(), balance.all.fed);
    const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
    double most = 0;
    double highest = 0;
    double steepest = 0;
    constexpr double kStep = 0.01;
    for (double y = -5; y < 5; y += 0.07)
        for (double x = -5; x < 5; x += 0.07) {
            for (const auto value : {&Swell::out, &Swell::rise}) {
                const auto at = [&](double px, double py) {
                    const Swell lower = stack.swell->at(toolpath, stack, 0, px, py);
                    const Swell upper = stack.swell->at(toolpath, stack, 1, px, py);
                    return std::max(lower.*value, upper.*value);
                };
                (value == &Swell::out ? most : highest) = std::max(value == &Swell::out ? most : highest, at(x, y));
                steepest =
                    std::max(steepest, std::hypot(at(x + kStep, y) - at(x, y), at(x, y + kStep) - at(x, y)) / kStep);
            }
        }
    EXPECT_NEAR(most, kMostSwell, 1e-6);
    EXPECT_NEAR(highest, std::min(kMostRise, kHeight / 2), 1e-6);
    EXPECT_LE(steepest, 1.5 * std::sqrt(2.0) * kMostSwell / kNodeSpacing * (1 + 1e-3));
}

TEST(SwellField, DoesNotDependOnTheOrderOfItsTiles) {
    // Two tiles high.
    gcode::Toolpath toolpath = solid(0.93, kTileLayers + 6);
    toolpath.deposit.beads = DepositModel::Beads::settled;
    toolpath.deposit.crown = 0.2;
    const LayerStack one = stackLayers(toolpath, test::allBeads(toolpath));
    const LayerStack other = stackLayers(toolpath, test::allBeads(toolpath));
    std::vector<TilePlace> places;
    for (const std::uint32_t z : {0, 1, 2})
        for (int n = -2; n <= 2; ++n)
            for (int m = -2; m <= 2; ++m) places.push_back({n, m, z});
    for (const TilePlace& place : places) one.swell->tile(toolpath, one, place);
    int made = 0;
    for (auto place = places.rbegin(); place != places.rend(); ++place) {
        const SwellTile* a = one.swell->tile(toolpath, one, *place);
        const SwellTile* b = other.swell->tile(toolpath, other, *place);
        ASSERT_EQ(a == nullptr, b == nullptr);
        if (a == nullptr) continue;
        ++made;
        EXPECT_EQ(a->out, b->out);
        EXPECT_EQ(a->rise, b->rise);
        EXPECT_EQ(a->open, b->open);
    }
    EXPECT_GT(made, 20);
    EXPECT_EQ(one.swell->tile(toolpath, one, {0, 0, 2}), nullptr) << "above the print";
}

// What a layer can't take goes on through the border of two tiles: the top of a block that is fed too much rises as far
// where it lies in the first layer of a tile as where it lies in the last.
TEST(SwellField, WhatMovesUpPassesBordersOfTiles) {
    const auto raisedOf = [](int layers) {
        gcode::Toolpath toolpath = solid(0.97, layers);
        return balanceOf(toolpath).raised;
    };
    const int border = static_cast<int>(kTileLayers);
    const double last = raisedOf(border);
    EXPECT_GT(last, 1.5 * raisedOf(2)) << "nothing comes from far below";
    for (const int layers : {border + 1, border + 2, border + 3}) {
        std::printf("  %d layers: %.4f mm3, %d: %.4f mm3\n", border, last, layers, raisedOf(layers));
        EXPECT_NEAR(raisedOf(layers), last, 0.05 * last) << layers;
    }
}

// A layer that lacks more than the one below has left over uses all of that up: nothing reaches the layer on it.
TEST(SwellField, WhatALayerLacksIsNotPassedOn) {
    const auto riseOfThird = [](double first, double second) {
        gcode::Toolpath toolpath = solid(0.97, 3);
        toolpath.deposit.beads = DepositModel::Beads::settled;
        const std::array<double, 3> flows{first, second, 1};  // of layers
        for (const gcode::Bead& bead : toolpath.beads) {
            const double flow = flows[toolpath.runOf(bead).layer - 1];
            toolpath.flow.push_back({static_cast<float>(flow * gcode::beadVolume(toolpath, bead)), 0, 0});
        }
        const LayerStack stack = stackLayers(toolpath, test::allBeads(toolpath));
        return stack.swell->at(toolpath, stack, 2, 0, 0).rise;
    };
    const double alone = riseOfThird(0.5, 0.9);
    EXPECT_GT(alone, 0);
    EXPECT_GT(riseOfThird(1, 1), 1.5 * alone) << "nothing comes from below";
    EXPECT_NEAR(riseOfThird(1, 0.9), alone, 1e-9);
}

// Round lines on the center plane of the upper layer are plastic where the layer's own lines were fed, too.
TEST(SwellField, WhatRoundBeadsShareFindsAPlace) {
    gcode::Toolpath toolpath = solid(1, 2);
    const DepositBalance without = balanceOf(toolpath);
    for (double y = -3; y <= 3; y += 1.5) test::addBead(toolpath, -3, y, 0.4, 3, y + 0.4, 0.4, 0.18, kHeight, 2);
    const DepositBalance with = balanceOf(toolpath);
    const double shared = with.shared - without.shared;
    EXPECT_GT(shared, 0.6);
    EXPECT_NEAR(with.unplaced(), without.unplaced(), 0.3 * shared);
    EXPECT_GT(with.pressed_out + with.raised, without.pressed_out + without.raised + 0.5 * shared);
}

TEST(SwellField, AWideningLineIsNotPressedOut) {
    gcode::Toolpath toolpath;
    test::addBead(toolpath, 0.1, 0.2, kHeight, 28, 3.2, kHeight, kWidth, kHeight);
    const double fed = gcode::beadVolume(toolpath);
    toolpath.flow.push_back({static_cast<float>(fed), 0, 0.06F});
    const DepositBalance balance = balanceOf(toolpath);
    EXPECT_NEAR(balance.all.fed, fed, 1e-4 * fed);
    // Laid evenly along the line, 3 % of it would be.
    EXPECT_LT(balance.pressed_out, 6e-3 * fed);
}

// Tiles are kept where beads are, not over the rectangle: 19 m apart it would have 1e8 of them.
TEST(SwellField, FarCopiesHoldWhatOneDoes) {
    gcode::Toolpath one = sparse();
    const DepositBalance single = balanceOf(one);
    gcode::Toolpath two = sparse();
    // A multiple of the tiles and of the measuring columns.
    constexpr double kApart = 19'200;
    for (gcode::Bead bead : one.beads) {
        bead.x0 = bead.x0 + kApart;
        bead.x1 = bead.x1 + kApart;
        bead.y0 = bead.y0 + kApart;
        bead.y1 = bead.y1 + kApart;
        two.beads.push_back(bead);
    }
    const DepositBalance both = balanceOf(two);
    EXPECT_NEAR(both.all.laid, 2 * single.all.laid, 2e-3 * single.all.laid);
    EXPECT_NEAR(both.pressed_out, 2 * single.pressed_out, 0.02 * single.pressed_out);
}

}  // namespace
}  // namespace stratum::voxelize

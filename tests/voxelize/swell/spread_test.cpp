#include "voxelize/swell/spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace stratum::voxelize {
namespace {

constexpr int kEdge = 40;
std::size_t nodeAt(int i, int j) { return static_cast<std::size_t>(j * kEdge + i); }

// An outline along the line i = 20: nodes there can gain up to `most` mm^3 each.
SpreadNodes outline(double most) {
    SpreadNodes nodes(kEdge);
    for (int j = 0; j < kEdge; ++j)
        for (std::size_t level = 0; level < nodes.gain.size(); ++level)
            nodes.gain[level][nodeAt(20, j)] = most * TileSums::kSwells[level] / kMostSwell;
    return nodes;
}
Spread spreadSurplus(const SpreadNodes& nodes, double most_rise) {
    return Spreading(kEdge).spread(nodes, NodeBox::all(kEdge), NodeBox::all(kEdge), most_rise);
}
double sum(const std::vector<float>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(SpreadSurplus, AllOfItFindsAPlaceWhereThereIsRoom) {
    SpreadNodes nodes = outline(0.01);
    nodes.surplus[nodeAt(19, 20)] = 0.002;
    nodes.surplus[nodeAt(22, 18)] = 0.001;
    const std::vector<float> given = spreadSurplus(nodes, kMostRise).given;
    EXPECT_NEAR(sum(given), 0.003, 3e-9);
    for (int j = 0; j < kEdge; ++j)
        for (int i = 0; i < kEdge; ++i)
            if (i != 20) {
                EXPECT_EQ(given[nodeAt(i, j)], 0);
            }
    EXPECT_GT(given[nodeAt(20, 20)], given[nodeAt(20, 22)]);
}

TEST(SpreadSurplus, NoNodeIsGivenMoreThanItCanGain) {
    for (const double surplus : {0.001, 0.03, 1.0, 1e6}) {
        SpreadNodes nodes = outline(0.01);
        nodes.surplus[nodeAt(20, 20)] = surplus;
        const std::vector<float> given = spreadSurplus(nodes, kMostRise).given;
        EXPECT_LE(*std::max_element(given.begin(), given.end()), 0.01);
        EXPECT_GE(*std::min_element(given.begin(), given.end()), 0);
        EXPECT_LE(sum(given), surplus * (1 + 1e-6));
        for (std::size_t n = 0; n < given.size(); ++n) {
            const double swell = swellThatGains(nodes, n, given[n]);
            EXPECT_TRUE(swell >= 0 && swell <= kMostSwell) << swell;
        }
    }
}

TEST(SpreadSurplus, WhatANodeIsShortOfComesFromItsNeighbours) {
    SpreadNodes nodes = outline(0.01);
    nodes.surplus[nodeAt(20, 20)] = 0.002;
    nodes.surplus[nodeAt(20, 21)] = -0.0005;
    EXPECT_NEAR(sum(spreadSurplus(nodes, kMostRise).given), 0.0015, 1e-9);
}

// A top that is open from i = 10 to 30, without outlines.
SpreadNodes openTop() {
    SpreadNodes nodes(kEdge);
    for (int j = 0; j < kEdge; ++j)
        for (int i = 10; i <= 30; ++i) nodes.open[nodeAt(i, j)] = kNodeSpacing * kNodeSpacing;
    return nodes;
}

TEST(SpreadSurplus, OpenTopsRiseWhereNoOutlineIsNear) {
    SpreadNodes nodes = openTop();
    nodes.surplus[nodeAt(20, 20)] = 0.002;
    nodes.surplus[nodeAt(12, 8)] = 0.001;
    nodes.surplus[nodeAt(12, 9)] = -0.0004;
    nodes.surplus[nodeAt(5, 20)] = 0.003;  // something lies on it
    const Spread spread = spreadSurplus(nodes, kMostRise);
    // Neighbours of the node that lacks something, but have no surplus, lend nothing.
    EXPECT_GT(sum(spread.raised), 0.0026);
    EXPECT_LT(sum(spread.raised), 0.0028);
    EXPECT_NEAR(sum(spread.raised) + sum(spread.left), 0.0056, 6e-9);
    EXPECT_NEAR(spread.left[nodeAt(5, 20)], 0.003, 3e-9);
    EXPECT_GT(spread.raised[nodeAt(20, 20)], spread.raised[nodeAt(21, 21)]);
    EXPECT_GT(spread.raised[nodeAt(21, 21)], 0);
}

TEST(SpreadSurplus, NoTopRisesMoreThanItMayAndNothingIsLost) {
    for (const double surplus : {0.001, 0.03, 1.0, 1e6}) {
        SpreadNodes nodes = openTop();
        nodes.surplus[nodeAt(20, 20)] = surplus;
        const Spread spread = spreadSurplus(nodes, 0.05);
        EXPECT_LE(*std::max_element(spread.raised.begin(), spread.raised.end()),
                  0.05 * kNodeSpacing * kNodeSpacing * (1 + 1e-6));
        EXPECT_NEAR(sum(spread.given) + sum(spread.raised) + sum(spread.left), surplus, 1e-6 * surplus);
    }
}

TEST(SpreadSurplus, WithoutAnOutlineNearbyItHasNoPlace) {
    SpreadNodes nodes = outline(0.01);
    nodes.surplus[nodeAt(20 - kFar - 1, 20)] = 0.002;
    EXPECT_EQ(sum(spreadSurplus(nodes, kMostRise).given), 0);
    EXPECT_EQ(sum(spreadSurplus(SpreadNodes(kEdge), kMostRise).given), 0);
}

TEST(SpreadSurplus, NothingBeyondTheHaloMatters) {
    SpreadNodes nodes = outline(0.01);
    nodes.surplus[nodeAt(20, 20)] = 0.02;
    const std::vector<float> before = spreadSurplus(nodes, kMostRise).given;
    for (int j = 0; j < kEdge; ++j)
        for (int i = 0; i < kEdge; ++i)
            if (std::max(std::abs(i - 20), std::abs(j - 18)) > kSpreadHalo) {
                nodes.surplus[nodeAt(i, j)] = 7;
                for (std::vector<float>& level : nodes.gain) level[nodeAt(i, j)] = 3;
            }
    EXPECT_EQ(spreadSurplus(nodes, kMostRise).given[nodeAt(20, 18)], before[nodeAt(20, 18)]);
    EXPECT_GT(before[nodeAt(20, 18)], 0);
}

// One that spreads layer after layer keeps nothing of those before, and leaves out what no wanted node depends on.
TEST(SpreadSurplus, TheWantedNodesAreRightInAnyOrder) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> value(0, 1);
    std::vector<SpreadNodes> layers;
    for (int n = 0; n < 8; ++n) {
        SpreadNodes& nodes = layers.emplace_back(kEdge);
        for (int j = n; j < kEdge - 3 * n; ++j)
            for (int i = 2 * n; i < kEdge - n; ++i) {
                const std::size_t at = nodeAt(i, j);
                nodes.surplus[at] = 0.02F * value(random) - 0.01F;
                for (std::vector<float>& level : nodes.gain)
                    level[at] = value(random) < 0.3F ? 0.02F * value(random) : 0;
                nodes.open[at] = n % 2 == 0 ? 0.1F * value(random) : 0;
            }
    }
    const NodeBox wanted{kSpreadHalo, kEdge - kSpreadHalo, kSpreadHalo, kEdge - kSpreadHalo};
    Spreading one(kEdge);
    for (const std::size_t n : {3, 0, 7, 1, 5, 2, 6, 4, 0}) {
        const Spread whole = spreadSurplus(layers[n], 0.05);
        const auto step = static_cast<int>(n);
        const NodeBox box{2 * step, kEdge - step, step, kEdge - 3 * step};
        const Spread& part = one.spread(layers[n], box, wanted, 0.05);
        for (int j = wanted.y0; j < wanted.y1; ++j)
            for (int i = wanted.x0; i < wanted.x1; ++i) {
                const std::size_t at = nodeAt(i, j);
                ASSERT_EQ(part.given[at], whole.given[at]) << n;
                ASSERT_EQ(part.raised[at], whole.raised[at]) << n;
                ASSERT_EQ(part.left[at], whole.left[at]) << n;
            }
    }
}

TEST(SwellThatGains, InvertsTheGain) {
    SpreadNodes nodes(1);
    nodes.gain[0][0] = 0.001;
    nodes.gain[1][0] = 0.004;
    nodes.gain[2][0] = 0.005;
    EXPECT_EQ(swellThatGains(nodes, 0, 0), 0);
    EXPECT_NEAR(swellThatGains(nodes, 0, 0.001), TileSums::kSwells[0], 1e-8);
    EXPECT_NEAR(swellThatGains(nodes, 0, 0.0025), 0.5 * (TileSums::kSwells[0] + TileSums::kSwells[1]), 1e-8);
    EXPECT_NEAR(swellThatGains(nodes, 0, 0.005), kMostSwell, 1e-8);
}

}  // namespace
}  // namespace stratum::voxelize

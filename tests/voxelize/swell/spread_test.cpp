#include "voxelize/swell/spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace stratum::voxelize {
namespace {

constexpr int kEdge = 40;
std::size_t nodeAt(int i, int j) { return static_cast<std::size_t>(j * kEdge + i); }

// An outline along the line i = 20: nodes there can gain up to `most` mm^3 each.
SpreadNodes outline(double most) {
    SpreadNodes nodes(kEdge);
    for (int j = 0; j < kEdge; ++j)
        for (std::size_t level = 0; level < nodes.gain.size(); ++level)
            nodes.gain[level][nodeAt(20, j)] = most * static_cast<double>(level + 1) / TileSums::kLevels;
    return nodes;
}
double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(SpreadSurplus, AllOfItFindsAPlaceWhereThereIsRoom) {
    SpreadNodes nodes = outline(0.01);
    nodes.surplus[nodeAt(19, 20)] = 0.002;
    nodes.surplus[nodeAt(22, 18)] = 0.001;
    const std::vector<double> given = spreadSurplus(nodes);
    EXPECT_NEAR(sum(given), 0.003, 1e-12);
    for (int j = 0; j < kEdge; ++j)
        for (int i = 0; i < kEdge; ++i)
            if (i != 20) EXPECT_EQ(given[nodeAt(i, j)], 0);
    EXPECT_GT(given[nodeAt(20, 20)], given[nodeAt(20, 22)]);
}

TEST(SpreadSurplus, NoNodeIsGivenMoreThanItCanGain) {
    for (const double surplus : {0.001, 0.03, 1.0, 1e6}) {
        SpreadNodes nodes = outline(0.01);
        nodes.surplus[nodeAt(20, 20)] = surplus;
        const std::vector<double> given = spreadSurplus(nodes);
        EXPECT_LE(*std::max_element(given.begin(), given.end()), 0.01);
        EXPECT_GE(*std::min_element(given.begin(), given.end()), 0);
        EXPECT_LE(sum(given), surplus * (1 + 1e-12));
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
    EXPECT_NEAR(sum(spreadSurplus(nodes)), 0.0015, 1e-9);
}

TEST(SpreadSurplus, WithoutAnOutlineNearbyItHasNoPlace) {
    SpreadNodes nodes = outline(0.01);
    nodes.surplus[nodeAt(20 - kFar - 1, 20)] = 0.002;
    EXPECT_EQ(sum(spreadSurplus(nodes)), 0);
    EXPECT_EQ(sum(spreadSurplus(SpreadNodes(kEdge))), 0);
}

TEST(SpreadSurplus, NothingBeyondTheHaloMatters) {
    SpreadNodes nodes = outline(0.01);
    nodes.surplus[nodeAt(20, 20)] = 0.02;
    const std::vector<double> before = spreadSurplus(nodes);
    for (int j = 0; j < kEdge; ++j)
        for (int i = 0; i < kEdge; ++i)
            if (std::max(std::abs(i - 20), std::abs(j - 18)) > kSpreadHalo) {
                nodes.surplus[nodeAt(i, j)] = 7;
                for (std::vector<double>& level : nodes.gain) level[nodeAt(i, j)] = 3;
            }
    EXPECT_EQ(spreadSurplus(nodes)[nodeAt(20, 18)], before[nodeAt(20, 18)]);
    EXPECT_GT(before[nodeAt(20, 18)], 0);
}

TEST(SwellThatGains, InvertsTheGain) {
    SpreadNodes nodes(1);
    nodes.gain[0][0] = 0.001;
    nodes.gain[1][0] = 0.004;
    nodes.gain[2][0] = 0.005;
    EXPECT_EQ(swellThatGains(nodes, 0, 0), 0);
    EXPECT_NEAR(swellThatGains(nodes, 0, 0.001), kMostSwell / 3, 1e-12);
    EXPECT_NEAR(swellThatGains(nodes, 0, 0.0025), kMostSwell / 2, 1e-12);
    EXPECT_NEAR(swellThatGains(nodes, 0, 0.005), kMostSwell, 1e-12);
}

}  // namespace
}  // namespace stratum::voxelize

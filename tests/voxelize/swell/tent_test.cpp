#include "voxelize/swell/tent.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace stratum::voxelize {
namespace {

std::vector<float> randomNodes(int edge) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(-1, 1);
    std::vector<float> nodes(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge));
    for (float& node : nodes) node = value(random);
    return nodes;
}

TEST(Tent, SumsAreThoseOfTheDefinition) {
    for (const int edge : {1, 2, 5, 17, 44, 60}) {
        const std::vector<float> nodes = randomNodes(edge);
        Tent tent(edge);
        std::vector<float> sums;
        for (int reach = 0; reach <= Tent::kMostReach; ++reach) {
            sums.assign(nodes.size(), 0.0F);
            tent.sum(nodes, NodeBox::all(edge), reach, NodeBox::all(edge), sums);
            for (int j = 0; j < edge; ++j)
                for (int i = 0; i < edge; ++i) {
                    double expected = 0;
                    for (int y = std::max(j - reach, 0); y <= std::min(j + reach, edge - 1); ++y)
                        for (int x = std::max(i - reach, 0); x <= std::min(i + reach, edge - 1); ++x)
                            expected += (1 - std::abs(x - i) / (reach + 1.0)) * (1 - std::abs(y - j) / (reach + 1.0)) *
                                        static_cast<double>(nodes[static_cast<std::size_t>(y * edge + x)]);
                    ASSERT_NEAR(sums[static_cast<std::size_t>(j * edge + i)], expected, 4e-6) << edge << " " << reach;
                }
        }
    }
}

TEST(Tent, NothingOutsideTheBoxesIsReadOrWritten) {
    constexpr int kEdge = 30;
    const std::vector<float> nodes = randomNodes(kEdge);
    const NodeBox from{3, 20, 7, 30};
    const NodeBox to{0, 25, 5, 29};
    std::vector<float> without = nodes;
    for (int j = 0; j < kEdge; ++j)
        for (int i = 0; i < kEdge; ++i)
            if (NodeBox{i, i + 1, j, j + 1}.within(from).empty()) without[static_cast<std::size_t>(j * kEdge + i)] = 0;
    Tent tent(kEdge);
    for (const int reach : {4, 1, 2}) {
        std::vector<float> sums(nodes.size(), 7);
        std::vector<float> expected(nodes.size(), 7);
        tent.sum(nodes, from, reach, to, sums);
        Tent(kEdge).sum(without, NodeBox::all(kEdge), reach, NodeBox::all(kEdge), expected);
        for (int j = 0; j < kEdge; ++j)
            for (int i = 0; i < kEdge; ++i) {
                const auto at = static_cast<std::size_t>(j * kEdge + i);
                const NodeBox node{i, i + 1, j, j + 1};
                ASSERT_EQ(sums[at], node.within(to).empty() ? 7 : expected[at]);
            }
    }
}

TEST(Tent, EveryInstructionSetGivesTheSameBytes) {
    const std::vector<float> nodes = randomNodes(45);
    std::vector<std::vector<float>> results;
    for (std::int64_t rest = hwy::SupportedTargets() & ~HWY_DISABLED_TARGETS; rest != 0; rest &= rest - 1) {
        hwy::SetSupportedTargetsForTest(rest & -rest);
        results.emplace_back(nodes.size());
        Tent(45).sum(nodes, NodeBox::all(45), 4, NodeBox::all(45), results.back());
    }
    hwy::SetSupportedTargetsForTest(0);
    for (const std::vector<float>& sums : results) EXPECT_EQ(sums, results[0]);
}

}  // namespace
}  // namespace stratum::voxelize

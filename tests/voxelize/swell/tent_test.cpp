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
            tent.sum(nodes, reach, sums);
            ASSERT_EQ(sums.size(), nodes.size());
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

TEST(Tent, EveryInstructionSetGivesTheSameBytes) {
    const std::vector<float> nodes = randomNodes(45);
    std::vector<std::vector<float>> results;
    for (std::int64_t rest = hwy::SupportedTargets() & ~HWY_DISABLED_TARGETS; rest != 0; rest &= rest - 1) {
        hwy::SetSupportedTargetsForTest(rest & -rest);
        Tent(45).sum(nodes, 4, results.emplace_back());
    }
    hwy::SetSupportedTargetsForTest(0);
    for (const std::vector<float>& sums : results) EXPECT_EQ(sums, results[0]);
}

}  // namespace
}  // namespace stratum::voxelize

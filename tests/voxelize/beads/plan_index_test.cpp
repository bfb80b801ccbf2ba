#include "voxelize/beads/plan_bins.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>

namespace stratum::voxelize {
namespace {

TEST(PlanIndex, NumbersAreThoseOfATable) {
    std::mt19937 random(5);
    for (const int reach : {3, 100, 2'000'000'000}) {
        std::uniform_int_distribution<int> where(-reach, reach);
        PlanIndex index;
        std::map<std::pair<int, int>, std::uint32_t> table;
        EXPECT_EQ(index.find(0, 0), PlanIndex::kNone);
        for (int n = 0; n < 3000; ++n) {
            const std::pair at(where(random), where(random));
            const auto next = static_cast<std::uint32_t>(table.size());
            EXPECT_EQ(index.add(at.first, at.second), table.try_emplace(at, next).first->second);
            const std::pair other(where(random), where(random));
            const auto found = table.find(other);
            EXPECT_EQ(index.find(other.first, other.second), found == table.end() ? PlanIndex::kNone : found->second);
        }
        ASSERT_EQ(index.size(), table.size());
        for (const auto& [at, number] : table)
            EXPECT_EQ(index.squares()[number], (PlanIndex::Square{at.first, at.second}));
    }
}

}  // namespace
}  // namespace stratum::voxelize

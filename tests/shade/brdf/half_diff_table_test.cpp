#include "shade/brdf/half_diff_table.h"

#include "shade/brdf_checks.h"
#include "shade/scan_checks.h"

#include <gtest/gtest.h>

#include <random>

namespace stratum {
namespace {

using shade::Color;
using shade::HalfDiffTable;

const HalfDiffTable& known() {
    static const HalfDiffTable table = HalfDiffTable::bake(
        [](const glm::dvec3& wo, const glm::dvec3& wi) { return glm::dvec3(test::knownBrdf(wi, wo)); });
    return table;
}

TEST(HalfDiffTable, CellsHaveTheirAngles) {
    std::mt19937 random(1);
    for (int n = 0; n < 2000; ++n) {
        const int half = int(random() % HalfDiffTable::kHalf);
        const int diff = int(random() % HalfDiffTable::kDiff);
        const int turn = int(random() % HalfDiffTable::kTurn);
        glm::dvec3 wo, wi;
        HalfDiffTable::directionsOf(half, diff, turn, wo, wi);
        ASSERT_NEAR(glm::length(wo), 1.0, 1e-12);
        if (wo.z < 0.01 || wi.z < 0.01) continue;
        const Color stored =
            known().values()[(std::size_t(half) * HalfDiffTable::kDiff + std::size_t(diff)) * HalfDiffTable::kTurn +
                             std::size_t(turn)];
        const Color found = known().at(glm::vec3(wo), glm::vec3(wi));
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(found[c], stored[c], 2e-3f * stored[c]) << half << " " << diff;
    }
}

TEST(HalfDiffTable, FollowsWhatWasBaked) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    double sum = 0.0;
    double largest = 0.0;
    constexpr int kDraws = 20000;
    for (int n = 0; n < kDraws; ++n) {
        const glm::vec3 wo = test::direction(0.05 + 0.95 * uniform(random), 6.28 * uniform(random));
        const glm::vec3 wi = test::direction(0.05 + 0.95 * uniform(random), 6.28 * uniform(random));
        const double e = double(known().at(wo, wi).r / test::knownBrdf(glm::dvec3(wi), glm::dvec3(wo)).r - 1.0f);
        sum += e * e;
        largest = std::max(largest, std::abs(e));
    }
    EXPECT_LT(std::sqrt(sum / kDraws), 3e-3);
    EXPECT_LT(largest, 0.05);
}

TEST(HalfDiffTable, IsReciprocalToTheBit) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int n = 0; n < 50000; ++n) {
        const glm::vec3 wo = test::direction(uniform(random), 6.28 * uniform(random));
        const glm::vec3 wi = test::direction(uniform(random), 6.28 * uniform(random));
        ASSERT_EQ(known().at(wo, wi), known().at(wi, wo));
    }
    EXPECT_TRUE(shade::isFinite(known().at({0, 0, 1}, {0, 0, 1})));
}

}  // namespace
}  // namespace stratum

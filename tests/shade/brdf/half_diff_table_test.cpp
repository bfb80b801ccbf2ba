#include "shade/brdf/half_diff_table.h"

#include "on_each_target.h"
#include "shade/brdf_checks.h"
#include "shade/scan_checks.h"

#include <gtest/gtest.h>

#include <hwy/targets.h>

#include <cstddef>
#include <random>
#include <vector>

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

struct Pairs {
    std::vector<glm::vec3> wo, wi;
};

/// Pairs all over the hemisphere: grazing ones, equal ones, mirror images, and those about the normal.
Pairs manyPairs(std::size_t count) {
    Pairs pairs;
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (std::size_t n = 0; n < count; ++n) {
        const glm::vec3 wo = n % 11 == 0 ? glm::vec3(0, 0, 1)
                                         : test::direction(n % 7 == 0 ? 1e-5 : uniform(random), 6.28 * uniform(random));
        pairs.wo.push_back(wo);
        pairs.wi.push_back(n % 5 == 0   ? glm::vec3(-wo.x, -wo.y, wo.z)
                           : n % 3 == 0 ? wo
                                        : test::direction(uniform(random), 6.28 * uniform(random)));
    }
    return pairs;
}

class HalfDiffStream : public test::OnEachTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, HalfDiffStream, test::allTargets(), test::targetName);

TEST_P(HalfDiffStream, IsOneByOne) {
    for (const std::size_t count : {0u, 1u, 63u, 64u, 65u, 20000u}) {
        const Pairs pairs = manyPairs(count);
        std::vector<Color> there(count);
        known().at(pairs.wo, pairs.wi, there);
        for (std::size_t n = 0; n < count; ++n) {
            const Color alone = known().at(pairs.wo[n], pairs.wi[n]);
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(there[n][c], alone[c], 2e-5f * alone[c]) << n;
        }
    }
}

TEST_P(HalfDiffStream, IsReciprocalToTheBit) {
    const Pairs pairs = manyPairs(5000);
    std::vector<Color> there(5000);
    std::vector<Color> back(5000);
    known().at(pairs.wo, pairs.wi, there);
    known().at(pairs.wi, pairs.wo, back);
    EXPECT_EQ(there, back);
}

TEST_P(HalfDiffStream, HasTheSameBitsOnEveryProcessor) {
    const Pairs pairs = manyPairs(5000);
    std::vector<Color> here(5000);
    std::vector<Color> there(5000);
    known().at(pairs.wo, pairs.wi, here);
    hwy::SetSupportedTargetsForTest(HWY_EMU128);
    known().at(pairs.wo, pairs.wi, there);
    EXPECT_EQ(here, there);
}

}  // namespace
}  // namespace stratum

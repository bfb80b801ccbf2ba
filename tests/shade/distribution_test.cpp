#include "shade/distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace stratum {
namespace {

TEST(Distribution2D, FollowsItsWeights) {
    // An empty row, an empty column and empty ends: none may ever be drawn.
    const std::vector<double> weights = {0, 1, 0, 3, 0, 0, 0, 0, 0, 2, 0, 2};
    const shade::Distribution2D table(weights, 4, 3);
    std::vector<int> count(12, 0);
    constexpr int kSide = 400;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            double pdf = 0.0;
            const glm::dvec2 p = table.sample({(i + 0.5) / kSide, (j + 0.5) / kSide}, pdf);
            const int cell = static_cast<int>(p.y * 3) * 4 + static_cast<int>(p.x * 4);
            ++count[static_cast<std::size_t>(cell)];
            ASSERT_DOUBLE_EQ(pdf, table.pdf(p));
            ASSERT_NEAR(pdf, weights[static_cast<std::size_t>(cell)] / 8.0 * 12.0, 1e-12);
        }
    }
    for (std::size_t c = 0; c < 12; ++c) EXPECT_NEAR(count[c] / double(kSide * kSide), weights[c] / 8.0, 2e-3);
}

TEST(Distribution2D, EndsOfTheUnitSquare) {
    const shade::Distribution2D table({0, 1, 0, 0}, 2, 2);
    for (const double u : {0.0, 0x1.fffffffffffffp-1, 1.0}) {
        double pdf = 0.0;
        const glm::dvec2 p = table.sample({u, u}, pdf);
        EXPECT_GE(p.x, 0.5);
        EXPECT_LT(p.y, 0.5);
        EXPECT_DOUBLE_EQ(pdf, 4.0);
    }
}

TEST(Distribution2D, NoWeightMeansUniform) {
    const shade::Distribution2D table({0, 0, 0, 0}, 2, 2);
    EXPECT_DOUBLE_EQ(table.pdf({0.1, 0.9}), 1.0);
}

TEST(SphereDistribution, IntegratesToOneAndAgreesWithItself) {
    const shade::SphereDistribution table([](const glm::dvec3& d) { return 0.1 + std::pow(std::max(d.x, 0.0), 8); }, 64,
                                          32);
    double sum = 0.0;
    constexpr int kRings = 512;
    for (int i = 0; i < kRings; ++i) {
        const double theta = std::numbers::pi * (i + 0.5) / kRings;
        for (int j = 0; j < 2 * kRings; ++j) {
            const double phi = std::numbers::pi * (j + 0.5) / kRings;
            sum += std::sin(theta) * double(table.pdf(glm::vec3(std::sin(theta) * std::cos(phi),
                                                                std::sin(theta) * std::sin(phi), std::cos(theta))));
        }
    }
    EXPECT_NEAR(sum * std::pow(std::numbers::pi / kRings, 2), 1.0, 1e-4);
    int differ = 0;
    for (int i = 0; i < 100; ++i) {
        for (int j = 0; j < 100; ++j) {
            float pdf = 0.0f;
            const glm::vec3 d = table.sample({(i + 0.5f) / 100, (j + 0.5f) / 100}, pdf);
            ASSERT_NEAR(d.x * d.x + d.y * d.y + d.z * d.z, 1.0f, 1e-5f);
            // Rounding the direction may move it over a cell's edge, rarely.
            differ += std::abs(pdf - table.pdf(d)) > 1e-3f * pdf;
        }
    }
    EXPECT_LT(differ, 10);
}

}  // namespace
}  // namespace stratum

#include "shade/environment/bilinear_distribution.h"

#include "shade/environment/scalar_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace stratum {
namespace {

using shade::BilinearDistribution;

std::vector<float> spiky(int columns, int rows, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    std::vector<float> weights;
    for (int i = 0; i < columns * rows; ++i) {
        const float u = uniform(random);
        weights.push_back(u < 0.3f ? 0.0f : u > 0.98f ? 1e5f * u : u);
    }
    return weights;
}

TEST(BilinearDistribution, DensityIsOneInAll) {
    for (const auto& [columns, rows] : {std::pair{8, 4}, {64, 32}, {2, 1}}) {
        const BilinearDistribution table(spiky(columns, rows, 3), columns, rows);
        const int nx = columns * 32;
        const int ny = rows * 64;
        double sum = 0.0;
        for (int i = 0; i < nx; ++i)
            for (int j = 0; j < ny; ++j) sum += test::densityOf(table, 0, {(i + 0.5) / nx, (j + 0.5) / ny});
        // Half of the first and last row of cells lies beyond the poles.
        EXPECT_LE(sum / nx / ny, 1.0 + 1e-9);
        EXPECT_GT(sum / nx / ny, rows > 4 ? 0.99 : 0.49);
    }
}

TEST(BilinearDistribution, SampleAndDensityAgree) {
    const int columns = 16;
    const int rows = 8;
    const BilinearDistribution table(spiky(columns, rows, 5), columns, rows);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    constexpr int kCells = 24;
    constexpr int kDraws = 400000;
    std::vector<double> seen(kCells * kCells, 0.0);
    int lost = 0;
    for (int n = 0; n < kDraws; ++n) {
        double pdf = 0.0;
        const double ux = uniform(random);
        const glm::dvec2 p = test::drawFrom(table, 0, {ux, uniform(random)}, pdf);
        if (!(pdf > 0.0)) {
            ++lost;
            continue;
        }
        ASSERT_TRUE(p.x >= 0.0 && p.x < 1.0 && p.y > 0.0 && p.y < 1.0);
        ASSERT_NEAR(test::densityOf(table, 0, p), pdf, 1e-6 * pdf + 1e-9);
        seen[static_cast<std::size_t>(int(p.y * kCells) * kCells + int(p.x * kCells))] += 1.0;
    }
    double chi2 = 0.0;
    int degrees = -1;
    double inside = 0.0;
    for (int r = 0; r < kCells; ++r) {
        for (int c = 0; c < kCells; ++c) {
            constexpr int kCuts = 64;
            double p = 0.0;
            for (int a = 0; a < kCuts; ++a)
                for (int b = 0; b < kCuts; ++b)
                    p +=
                        test::densityOf(table, 0, {(c + (a + 0.5) / kCuts) / kCells, (r + (b + 0.5) / kCuts) / kCells});
            const double expected = p / (kCuts * kCuts * kCells * kCells) * kDraws;
            inside += expected;
            if (expected < 20.0) continue;
            const double d = seen[static_cast<std::size_t>(r * kCells + c)] - expected;
            chi2 += d * d / expected;
            ++degrees;
        }
    }
    EXPECT_LT((chi2 - degrees) / std::sqrt(2.0 * degrees), 4.0);
    EXPECT_NEAR(lost, kDraws - inside, 5.0 * std::sqrt(kDraws - inside + 1.0) + 0.002 * kDraws);
}

TEST(BilinearDistribution, NothingBrightMeansEverywhere) {
    const BilinearDistribution table(std::vector<float>(32, 0.0f), 8, 4);
    // The sphere's density: pi / 2 sin(pi v), by rows.
    EXPECT_NEAR(test::densityOf(table, 0, {0.3, 0.5}), std::numbers::pi / 2.0, 0.15);
}

}  // namespace
}  // namespace stratum

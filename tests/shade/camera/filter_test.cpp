#include "shade/camera/filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum {
namespace {

TEST(PixelFilter, DrawsByItsWeight) {
    const shade::PixelFilter filter;
    constexpr int kCells = 30;
    constexpr int kSamples = 300000;
    std::array<double, kCells> seen{};
    double before = -2.0;
    for (int i = 0; i < kSamples; ++i) {
        const double x = filter.offset({(i + 0.5f) / kSamples, 0.5f}).x;
        ASSERT_GE(x, before);
        ASSERT_LE(std::abs(x), shade::PixelFilter::kRadius);
        before = x;
        seen[static_cast<std::size_t>(std::min(kCells - 1, static_cast<int>((x + 1.5) / 3.0 * kCells)))] +=
            1.0 / kSamples;
    }
    double total = 0.0;
    for (int i = 0; i < 3000; ++i) total += shade::PixelFilter::weight(-1.5 + (i + 0.5) / 1000);
    for (int c = 0; c < kCells; ++c) {
        double expected = 0.0;
        for (int i = 0; i < 100; ++i) expected += shade::PixelFilter::weight(-1.5 + 0.1 * c + (i + 0.5) / 1000);
        EXPECT_NEAR(seen[static_cast<std::size_t>(c)], expected / total, 1e-3);
    }
    EXPECT_NEAR(filter.offset({0.5f, 0.5f}).y, 0.0, 1e-6);
    EXPECT_EQ(shade::PixelFilter::weight(1.6), 0.0);
}

}  // namespace
}  // namespace stratum

#include "animate/pace.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace stratum::animate {
namespace {

TEST(Pace, WithoutEaseIsEven) {
    for (const double share : {0.0, 0.1, 0.5, 1.0}) EXPECT_DOUBLE_EQ(paced(share, 0), share);
}

TEST(Pace, EaseBeginsAndEndsAtRestAndIsEvenBetween) {
    for (const double ease : {0.1, 0.25, 0.5}) {
        EXPECT_DOUBLE_EQ(paced(0, ease), 0.0);
        EXPECT_DOUBLE_EQ(paced(0.5, ease), 0.5);
        EXPECT_DOUBLE_EQ(paced(1, ease), 1.0);
        constexpr double kStep = 1e-6;
        const auto speedAt = [&](double share) {
            return (paced(share + kStep, ease) - paced(share - kStep, ease)) / (2 * kStep);
        };
        const double fastest = 1 / (1 - ease);
        EXPECT_NEAR(paced(kStep, ease) / kStep, 0.0, 1e-4);
        EXPECT_NEAR((1 - paced(1 - kStep, ease)) / kStep, 0.0, 1e-4);
        EXPECT_NEAR(speedAt(ease / 2), fastest / 2, 1e-6);
        EXPECT_NEAR(speedAt(1 - ease / 4), fastest / 4, 1e-6);
        EXPECT_NEAR(speedAt(0.5), fastest, 1e-4);
        for (double share = 0; share < 1; share += 0.01)
            EXPECT_LT(paced(share, ease), paced(share + 0.01, ease)) << ease << " " << share;
    }
}

TEST(Pace, APrintIsWholeWhileItIsHeld) {
    EXPECT_EQ(growthShares(4, 0, 0), (std::vector<double>{0.25, 0.5, 0.75, 1}));
    EXPECT_EQ(growthShares(6, 2, 0), (std::vector<double>{0.25, 0.5, 0.75, 1, 1, 1}));
    EXPECT_EQ(growthShares(3, 2, 0.5), (std::vector<double>{1, 1, 1}));
    const std::vector<double> eased = growthShares(100, 20, 0.25);
    EXPECT_TRUE(std::is_sorted(eased.begin(), eased.end()));
    EXPECT_LT(eased[0], 1e-3);
    EXPECT_LT(eased[78], 1.0);
    EXPECT_EQ(eased[79], 1.0);
}

}  // namespace
}  // namespace stratum::animate

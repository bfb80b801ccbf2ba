#include "motion/trapezoid.h"

#include "motions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stratum::motion {
namespace {

TEST(Trapezoid, FromRestToRest) {
    // 100 mm at 50 mm/s and 1000 mm/s^2: 0.05 s up, 0.05 s down, 1.25 mm each, 97.5 mm between.
    const Trapezoid t = fastest(100, 1000, 0, 2500, 0);
    EXPECT_DOUBLE_EQ(t.rising, 0.05);
    EXPECT_DOUBLE_EQ(t.falling, 0.05);
    EXPECT_DOUBLE_EQ(t.cruising, 97.5 / 50);
    EXPECT_DOUBLE_EQ(t.peak, 50);
}

TEST(Trapezoid, TooShortToCruise) {
    // Half the way up, half down: v = sqrt(a d).
    const Trapezoid t = fastest(1, 1000, 0, 1e6, 0);
    EXPECT_NEAR(t.peak, std::sqrt(1000), 1e-12);
    EXPECT_EQ(t.cruising, 0);
    EXPECT_NEAR(t.seconds(), 2 * std::sqrt(1000) / 1000, 1e-12);
}

TEST(Trapezoid, OnlyUpOrOnlyDown) {
    const Trapezoid up = fastest(2, 100, 0, 1e6, 400);
    EXPECT_NEAR(up.seconds(), 0.2, 1e-12);
    EXPECT_EQ(up.falling, 0);
    const Trapezoid down = fastest(2, 100, 400, 1e6, 0);
    EXPECT_NEAR(down.seconds(), 0.2, 1e-12);
    EXPECT_EQ(down.rising, 0);
}

TEST(Trapezoid, CoversItsLength) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> logarithm(-4, 4);
    for (int i = 0; i < 100000; ++i) {
        const double length = std::pow(10, logarithm(random));
        const double acceleration = std::pow(10, logarithm(random));
        const double most = std::pow(10, logarithm(random));
        std::uniform_real_distribution<double> share(0, 1);
        const double entry = share(random) * most;
        const double reach = 2 * acceleration * length;
        const double exit = std::clamp(share(random) * most, entry - reach < 0 ? 0 : entry - reach, entry + reach);
        const Trapezoid t = fastest(length, acceleration, entry, most, std::min(exit, most));
        ASSERT_NEAR(coveredBy(t), length, 1e-9 * length + 1e-11 * most / acceleration);
        ASSERT_LE(t.peak * t.peak, most * (1 + 1e-12));
    }
}

TEST(Trapezoid, ThroughAPeakBelowTheHighest) {
    // 1 mm from rest to rest at 1000 mm/s^2 through v^2 = 500: a quarter up, half cruised, a quarter down.
    const Trapezoid t = throughPeak(1, 1000, 0, 500, 0);
    EXPECT_NEAR(t.cruising * t.peak, 0.5, 1e-12);
    EXPECT_NEAR(t.rising, std::sqrt(500) / 1000, 1e-12);
    EXPECT_NEAR(coveredBy(t), 1, 1e-12);
}

TEST(Trapezoid, PartsAddUpToTheWhole) {
    const Trapezoid whole = fastest(10, 100, 4, 400, 25);
    for (const int count : {1, 2, 7, 100}) {
        double seconds = 0;
        double before = whole.entry;
        for (int i = 0; i < count; ++i) {
            const Trapezoid part = partOf(whole, 10.0 * i / count, 10.0 * (i + 1) / count);
            EXPECT_NEAR(part.entry, before, 1e-9);
            EXPECT_NEAR(coveredBy(part), 10.0 / count, 1e-9);
            before = part.exit;
            seconds += part.seconds();
        }
        EXPECT_NEAR(before, whole.exit, 1e-9);
        EXPECT_NEAR(seconds, whole.seconds(), 1e-9);
    }
}

}  // namespace
}  // namespace stratum::motion

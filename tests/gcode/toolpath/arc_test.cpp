#include "gcode/toolpath/arc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

constexpr bool kClockwise = true;
constexpr bool kCounterClockwise = false;

void expectArc(const std::optional<Arc>& arc, double x, double y, double sweep) {
    ASSERT_TRUE(arc.has_value());
    EXPECT_NEAR(arc->center_x, x, 1e-9);
    EXPECT_NEAR(arc->center_y, y, 1e-9);
    EXPECT_NEAR(arc->sweep, sweep, 1e-9);
}

TEST(Arc, FromOffset) {
    // From (1,0) to (0,1) about the origin: a quarter one way, three quarters the other.
    expectArc(arcFromOffset({1, 0}, {0, 1}, {-1, 0}, kCounterClockwise), 0, 0, std::numbers::pi / 2);
    expectArc(arcFromOffset({1, 0}, {0, 1}, {-1, 0}, kClockwise), 0, 0, -1.5 * std::numbers::pi);
    expectArc(arcFromOffset({10, 5}, {14, 5}, {2, 0}, kClockwise), 12, 5, -std::numbers::pi);
    expectArc(arcFromOffset({10, 5}, {14, 5}, {2, 0}, kCounterClockwise), 12, 5, std::numbers::pi);
}

TEST(Arc, FullCircle) {
    expectArc(arcFromOffset({3, 3}, {3, 3}, {0, -2}, kCounterClockwise), 3, 1, 2 * std::numbers::pi);
    expectArc(arcFromOffset({3, 3}, {3, 3}, {0, -2}, kClockwise), 3, 1, -2 * std::numbers::pi);
}

TEST(Arc, KlippersSweepIsTheUsualOneIfTheEndIsNotTheStart) {
    EXPECT_NEAR(klipperSweep({1, 0}, {0, 1}, {-1, 0}, kCounterClockwise), std::numbers::pi / 2, 1e-12);
    EXPECT_NEAR(klipperSweep({1, 0}, {0, 1}, {-1, 0}, kClockwise), -1.5 * std::numbers::pi, 1e-12);
    EXPECT_EQ(klipperSweep({1, 0}, {1, 0}, {-1, 0}, kCounterClockwise), 2 * std::numbers::pi);
}

TEST(Arc, AboutHalfOfKlippersFullCirclesAreNothing) {
    int nothing = 0;
    int circles = 0;
    for (int i = 0; i < 1000; ++i) {
        // Three decimals, as slicers write them.
        const PlanPoint at{(100000 + 137 * i) / 1000.0, (90000 + 59 * i) / 1000.0};
        const PlanPoint offset{(700 - i) / 1000.0, (i * 7 % 1000) / 1000.0};
        const double sweep = klipperSweep(at, at, offset, kCounterClockwise);
        nothing += std::abs(sweep) < 1e-9 ? 1 : 0;
        circles += std::abs(sweep - 2 * std::numbers::pi) < 1e-9 ? 1 : 0;
    }
    EXPECT_EQ(nothing + circles, 1000);
    EXPECT_GT(nothing, 350);
    EXPECT_GT(circles, 350);
}

TEST(Arc, FromRadiusOfEitherSign) {
    // NIST: a positive radius turns through less than 180 degrees, a negative one through more.
    expectArc(arcFromRadius({1, 0}, {0, 1}, 1, kCounterClockwise), 0, 0, std::numbers::pi / 2);
    expectArc(arcFromRadius({1, 0}, {0, 1}, -1, kCounterClockwise), 1, 1, 1.5 * std::numbers::pi);
    expectArc(arcFromRadius({1, 0}, {0, 1}, 1, kClockwise), 1, 1, -std::numbers::pi / 2);
    expectArc(arcFromRadius({1, 0}, {0, 1}, -1, kClockwise), 0, 0, -1.5 * std::numbers::pi);
    expectArc(arcFromRadius({0, 0}, {4, 0}, 2, kClockwise), 2, 0, -std::numbers::pi);
}

TEST(Arc, ARadiusRoundedDownStillReaches) {
    const auto arc = arcFromRadius({0, 0}, {4, 0}, 1.9996, kCounterClockwise);
    expectArc(arc, 2, 0, std::numbers::pi);
}

TEST(Arc, RoundedEndsAreForgiven) {
    expectArc(arcFromOffset({1, 0}, {0, 1.02}, {-1, 0}, kCounterClockwise), 0, 0, std::numbers::pi / 2);
}

TEST(Arc, WhatIsNone) {
    EXPECT_FALSE(arcFromOffset({0, 0}, {1, 0}, {0, 0}, kClockwise));   // no radius
    EXPECT_FALSE(arcFromOffset({1, 0}, {0, 3}, {-1, 0}, kClockwise));  // end off the circle
    EXPECT_FALSE(arcFromRadius({0, 0}, {0, 0}, 1, kClockwise));        // any of infinitely many
    EXPECT_FALSE(arcFromRadius({0, 0}, {10, 0}, 2, kClockwise));       // out of reach
    EXPECT_FALSE(arcFromRadius({0, 0}, {1, 0}, 0, kClockwise));        //
}

TEST(Arc, ToleranceIsAbsoluteForSmallAndRelativeForLargeRadii) {
    EXPECT_TRUE(arcFromOffset({1, 0}, {0, 1.09}, {-1, 0}, kCounterClockwise));
    EXPECT_FALSE(arcFromOffset({1, 0}, {0, 1.11}, {-1, 0}, kCounterClockwise));
    EXPECT_TRUE(arcFromOffset({100, 0}, {0, 104}, {-100, 0}, kCounterClockwise));
    EXPECT_FALSE(arcFromOffset({100, 0}, {0, 106}, {-100, 0}, kCounterClockwise));
}

}  // namespace
}  // namespace stratum::gcode

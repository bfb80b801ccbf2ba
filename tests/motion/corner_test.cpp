#include "motion/corner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::MachineLimits;

Segment along(double angle, double speed, double acceleration = 1000, double length = 100) {
    Segment segment;
    segment.length = length;
    segment.speed = segment.asked = speed;
    segment.acceleration = acceleration;
    segment.direction = {std::cos(angle), std::sin(angle), 0, 0};
    segment.travels = true;
    return segment;
}

MachineLimits with(CornerRule rule) {
    MachineLimits limits;
    limits.rule = rule;
    limits.printing = limits.travel = 1000;
    return limits;
}

constexpr double kRight = std::numbers::pi / 2;

TEST(Corner, JerkLimitsTheJumpOfEachAxis) {
    MachineLimits limits = with(CornerRule::jerk);
    limits.jerk = {10, 10, 0.2, 2.5};
    // 60 degrees at 100 mm/s: x jumps by 50 v/100, y by 86.6 v/100: y decides.
    EXPECT_NEAR(cornerSpeed(along(0, 100), along(std::numbers::pi / 3, 100), limits),
                10 / std::sin(std::numbers::pi / 3), 1e-9);
    // A right angle: each axis starts or stops; 10 mm/s.
    EXPECT_NEAR(cornerSpeed(along(0, 100), along(kRight, 100), limits), 10, 1e-9);
    // Back: the machine stops with its jump and starts with it.
    EXPECT_NEAR(cornerSpeed(along(0, 100), along(std::numbers::pi, 100), limits), 10, 1e-9);
    EXPECT_EQ(cornerSpeed(along(0, 100), along(0, 100), limits), 100);
    EXPECT_EQ(restSpeed(along(0, 100), limits), 10);
    EXPECT_EQ(restSpeed(along(0, 4), limits), 4);
}

TEST(Corner, SlicersTakeWhatWasAskedOfAMoveThatAnAxisHoldsBack) {
    MachineLimits limits = with(CornerRule::jerk);
    Segment lift;
    lift.length = 0.2;
    lift.asked = 150;
    lift.speed = 12;
    lift.acceleration = 500;
    lift.direction = {0, 0, 1, 0};
    lift.travels = true;
    EXPECT_NEAR(cornerSpeed(lift, along(0, 150), limits), 10, 1e-9);  // stopping and starting anew is faster
    limits.rule = CornerRule::slicer_jerk;
    EXPECT_NEAR(cornerSpeed(lift, along(0, 150), limits), 150 * 0.2 / 12, 1e-9);
}

// BambuStudio's numbers by hand: x loses 100, y gains 100; x alone takes a factor of 9/100, which holds for what is
// left of y's jump as well.
TEST(Corner, BambuStudioTakesTheAxesOneAfterTheOther) {
    MachineLimits limits = with(CornerRule::bambu_jerk);
    limits.jerk = {9, 9, 3, 2.5};
    Segment from = along(0, 100);
    from.exit = {1, 0};
    EXPECT_NEAR(cornerSpeed(from, along(kRight, 100), limits), 9, 1e-9);
    // From the tangent of an arc's end to a line along it there is no corner.
    from.whole_arc = true;
    from.direction = {0, 1, 0, 0};
    EXPECT_NEAR(cornerSpeed(from, along(0, 80), limits), 80, 1e-9);
}

// v^2 = a r, of an arc and of a polygon about as large a circle.
TEST(Corner, CurvesHaveACentripetalAcceleration) {
    MachineLimits limits = with(CornerRule::bambu_jerk);
    limits.printing = 5000;
    Segment arc = along(0, 300);
    arc.whole_arc = true;
    arc.radius = 2;
    EXPECT_NEAR(curveSpeed(nullptr, arc, limits), 100, 1e-9);
    constexpr double kTurn = 0.1;
    Segment before = along(0, 300);
    before.exit = {1, 0};
    Segment after = along(kTurn, 300);
    after.length = 2 * 2 * std::sin(kTurn / 2);  // a chord of that circle
    EXPECT_NEAR(curveSpeed(&before, after, limits), 100, 1e-9);
    EXPECT_EQ(curveSpeed(&before, along(0, 300), limits), MachineLimits::kNone);       // straight on
    EXPECT_EQ(curveSpeed(&before, along(kRight, 300), limits), MachineLimits::kNone);  // a corner
}

TEST(Corner, PlanJerkCountsTheVectorsJump) {
    MachineLimits limits = with(CornerRule::plan_jerk);
    limits.jerk = {20, 20, 0.4, 5};
    EXPECT_NEAR(cornerSpeed(along(0, 100), along(kRight, 100), limits), 100 * 20 / (100 * std::numbers::sqrt2), 1e-9);
    EXPECT_EQ(restSpeed(along(0, 100), limits), 10);
}

TEST(Corner, RepRapFirmwareSharesOneSpeedThatNoAxisJumpsTooFarBy) {
    MachineLimits limits = with(CornerRule::reprap_jerk);
    limits.jerk = {10, 8, 0.2, 2.5};
    // A right angle: y jumps by the whole speed.
    EXPECT_NEAR(cornerSpeed(along(0, 100), along(kRight, 100), limits), 8, 1e-9);
    // Back: twice the speed, in x.
    EXPECT_NEAR(cornerSpeed(along(0, 100), along(std::numbers::pi, 100), limits), 5, 1e-9);
    EXPECT_EQ(cornerSpeed(along(0, 100), along(0, 60), limits), 60);
    EXPECT_EQ(restSpeed(along(0, 100), limits), 0);
}

TEST(Corner, RepRapFirmwareStopsBetweenKindsOfMoves) {
    MachineLimits limits = with(CornerRule::reprap_jerk);
    Segment prints = along(0, 60);
    prints.direction[3] = 0.03;
    EXPECT_EQ(cornerSpeed(along(0, 100), prints, limits), 0);
    EXPECT_EQ(cornerSpeed(prints, prints, limits), 60);
    limits.jerk_policy = 1;
    EXPECT_EQ(cornerSpeed(along(0, 100), prints, limits), 60);
}

TEST(Corner, NothingOfNoJerk) {
    MachineLimits limits = with(CornerRule::jerk);
    limits.jerk = {0, 0, 0, 0};
    EXPECT_EQ(cornerSpeed(along(0, 100), along(1, 100), limits), 0);
    EXPECT_EQ(restSpeed(along(0, 100), limits), 0);
}

}  // namespace
}  // namespace stratum::motion

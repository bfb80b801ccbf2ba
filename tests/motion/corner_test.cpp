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

TEST(Corner, JunctionDeviationByItsFormula) {
    const MachineLimits limits = with(CornerRule::junction_deviation);
    // v^2 = a d sin(t/2) / (1 - sin(t/2)), t the angle inside the corner.
    for (const double turn : {0.3, 1.0, kRight, 2.0, 3.0}) {
        const double sine = std::sin((std::numbers::pi - turn) / 2);
        EXPECT_NEAR(cornerSpeed(along(0, 1000), along(turn, 1000), limits), std::sqrt(1000 * 0.013 * sine / (1 - sine)),
                    1e-9)
            << turn;
    }
    EXPECT_EQ(cornerSpeed(along(0, 80), along(0, 60), limits), 60);
    EXPECT_LE(cornerSpeed(along(0, 80), along(std::numbers::pi, 80), limits), 0.05);
}

TEST(Corner, ShortPiecesOfACurveGoAsItsCircleAllows) {
    const MachineLimits limits = with(CornerRule::junction_deviation);
    const double turn = 0.1;  // of 0.5 mm: radius 5 mm
    EXPECT_NEAR(cornerSpeed(along(0, 1000, 1000, 0.5), along(turn, 1000, 1000, 0.5), limits), std::sqrt(1000 * 5),
                1e-6);
}

TEST(Corner, KlippersRightAngleIsTheSquareCornerVelocity) {
    MachineLimits limits = with(CornerRule::corner_velocity);
    for (const double velocity : {1.0, 5.0, 20.0}) {
        limits.corner_velocity = velocity;
        EXPECT_NEAR(cornerSpeed(along(0, 300), along(kRight, 300), limits), velocity, 1e-9);
    }
    limits.corner_velocity = 5;
    // Whatever the acceleration: d = scv^2 (sqrt 2 - 1) / a.
    EXPECT_NEAR(cornerSpeed(along(0, 300), along(kRight, 300), limits), 5, 1e-9);
    EXPECT_EQ(cornerSpeed(along(0, 300), along(0, 200), limits), 200);
    EXPECT_NEAR(cornerSpeed(along(0, 300), along(std::numbers::pi, 300), limits), 0, 1e-6);
    for (const double turn : {0.5, 1.0, 2.0}) {
        const double sine = std::sin((std::numbers::pi - turn) / 2);
        EXPECT_NEAR(cornerSpeed(along(0, 300), along(turn, 300), limits),
                    std::sqrt(25 * (std::numbers::sqrt2 - 1) * sine / (1 - sine)), 1e-9);
    }
}

TEST(Corner, KlipperBoundsShortPiecesByTheCircleThatTheyTouch) {
    const MachineLimits limits = with(CornerRule::corner_velocity);
    const double turn = 0.1;
    const double tangent = std::tan((std::numbers::pi - turn) / 2);
    EXPECT_NEAR(cornerSpeed(along(0, 300, 1000, 0.01), along(turn, 300, 1000, 5), limits),
                std::sqrt(0.01 * 1000 * tangent / 2), 1e-9);
}

TEST(Corner, KlippersExtruderHasItsOwnBound) {
    const MachineLimits limits = with(CornerRule::corner_velocity);
    Segment fed = along(0, 300);
    fed.direction[3] = 0.05;
    EXPECT_NEAR(cornerSpeed(along(0, 300), fed, limits), 1 / 0.05, 1e-9);
    Segment pull;
    pull.length = 1;
    pull.speed = 30;
    pull.acceleration = 1000;
    pull.direction = {0, 0, 0, -1};
    EXPECT_EQ(cornerSpeed(along(0, 300), pull, limits), 0);
}

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

TEST(Corner, PlanJerkCountsTheVectorsJump) {
    MachineLimits limits = with(CornerRule::plan_jerk);
    limits.jerk = {20, 20, 0.4, 5};
    EXPECT_NEAR(cornerSpeed(along(0, 100), along(kRight, 100), limits), 100 * 20 / (100 * std::numbers::sqrt2), 1e-9);
    EXPECT_EQ(restSpeed(along(0, 100), limits), 10);
}

TEST(Corner, NothingOfNoJerk) {
    MachineLimits limits = with(CornerRule::jerk);
    limits.jerk = {0, 0, 0, 0};
    EXPECT_EQ(cornerSpeed(along(0, 100), along(1, 100), limits), 0);
    EXPECT_EQ(restSpeed(along(0, 100), limits), 0);
}

}  // namespace
}  // namespace stratum::motion

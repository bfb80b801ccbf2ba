#include "motion/klipper_look_ahead.h"

#include "motions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::MachineLimits;

MachineLimits klipperLimits(double acceleration = 1000) {
    MachineLimits limits;
    limits.rule = CornerRule::corner_velocity;
    limits.path_speed = 300;
    limits.printing = limits.travel = acceleration;
    limits.speed[2] = limits.extrude_only_speed = 1000;
    limits.acceleration[2] = limits.retracting = 100000;
    return limits;
}

// A move, and the limits that hold when it is made.
struct Step {
    gcode::Move move;
    MachineLimits limits;
};

PlanList plannedSteps(const std::vector<Step>& steps) {
    PlanKeeper keeper;
    Planner planner(keeper);
    for (const Step& step : steps) {
        planner.limits(step.limits);
        planner.move(step.move);
    }
    planner.finish();
    keeper.list.seconds = planner.seconds();
    expectSound(keeper.list);
    return keeper.list;
}

PlanList soundKlipperPlan(const MachineLimits& limits, const std::vector<gcode::Move>& moves) {
    std::vector<Step> steps;
    for (const gcode::Move& move : moves) steps.push_back({move, limits});
    return plannedSteps(steps);
}

// mm/s between two moves of 100 mm, the second one turned left.
double klipperCorner(double turn, const MachineLimits& limits, double length = 100) {
    return soundKlipperPlan(limits, {straight(100, 0, 0, 0, 300),
                                     straight(length * std::cos(turn), length * std::sin(turn), 0, 0, 300)})
        .pieces[1]
        .speed.entry;
}

TEST(KlipperLookAhead, ARightAngleIsTakenAtTheSquareCornerVelocity) {
    for (const double acceleration : {1000.0, 20000.0})
        for (const double velocity : {1.0, 5.0, 20.0}) {
            MachineLimits limits = klipperLimits(acceleration);
            limits.corner_velocity = velocity;
            EXPECT_NEAR(klipperCorner(std::numbers::pi / 2, limits), velocity, 1e-9);
        }
    EXPECT_NEAR(klipperCorner(std::numbers::pi, klipperLimits()), 0, 1e-6);
    for (const double turn : {0.5, 1.0, 2.0}) {
        // v^2 = d a s / (1 - s), d a = scv^2 (sqrt 2 - 1), s the sine of half the angle inside.
        const double sine = std::sin((std::numbers::pi - turn) / 2);
        EXPECT_NEAR(klipperCorner(turn, klipperLimits()), std::sqrt(25 * (std::numbers::sqrt2 - 1) * sine / (1 - sine)),
                    1e-9);
    }
}

TEST(KlipperLookAhead, ShortMovesTouchTheirCircleNoFurtherThanHalfWay) {
    // v^2 = a l tan(t / 2) / 2, t the angle inside the corner.
    const double turn = 0.1;
    EXPECT_NEAR(klipperCorner(turn, klipperLimits(), 0.01),
                std::sqrt(std::min(0.01 * 1000 * std::tan((std::numbers::pi - turn) / 2) / 2, 2 * 1000 * 0.01)), 1e-9);
}

TEST(KlipperLookAhead, TheExtruderJumpsByItsCornerVelocity) {
    MachineLimits limits = klipperLimits();
    const std::vector<gcode::Move> moves{straight(100, 0, 0, 0, 300), straight(100, 0, 0, 5, 300)};
    EXPECT_NEAR(soundKlipperPlan(limits, moves).pieces[1].speed.entry, 1 / 0.05, 1e-9);
    limits.extruder_corner_velocity = 3;
    EXPECT_NEAR(soundKlipperPlan(limits, moves).pieces[1].speed.entry, 3 / 0.05, 1e-9);
}

TEST(KlipperLookAhead, MovesOfTheExtruderAloneBeginAndEndAtRest) {
    const PlanList plan = soundKlipperPlan(
        klipperLimits(), {straight(10, 0, 0, 0, 100), straight(0, 0, 0, -1, 30), straight(10, 0, 0, 0, 100)});
    EXPECT_EQ(plan.pieces[1].speed.entry, 0);
    EXPECT_EQ(plan.pieces[2].speed.entry, 0);
}

TEST(KlipperLookAhead, ShortMovesCruiseAPartOfTheirLength) {
    // 1 mm to and fro at 1000 mm/s^2: half the acceleration decides the peak, v^2 = a d / 2; half the way is cruised.
    MachineLimits limits = klipperLimits();
    std::vector<gcode::Move> moves;
    for (int i = 0; i < 10; ++i) moves.push_back(straight(i % 2 == 0 ? 1 : -1, 0, 0, 0, 300));
    for (const PlannedPiece& piece : soundKlipperPlan(limits, moves).pieces) {
        EXPECT_NEAR(piece.speed.peak, std::sqrt(500), 1e-9);
        EXPECT_NEAR(piece.speed.cruising * piece.speed.peak, 0.5, 1e-9);
    }
    limits.cruise_ratio = 0;
    EXPECT_NEAR(soundKlipperPlan(limits, moves).pieces[3].speed.peak, std::sqrt(1000), 1e-9);
}

TEST(KlipperLookAhead, WeakAxesAreSmoothedByTheMachinesAcceleration) {
    // The smoothed acceleration is the lower of the move's own and of half the machine's (1500): z at 100 mm/s^2 goes
    // v^2 = 100 d, and does not cruise.
    MachineLimits limits = klipperLimits(3000);
    limits.acceleration[2] = 100;
    limits.retracting = 800;
    const auto peakOf = [&](const gcode::Move& move) { return soundKlipperPlan(limits, {move}).pieces[0].speed.peak; };
    EXPECT_NEAR(peakOf(straight(0, 0, 1, 0, 300)), std::sqrt(100), 1e-9);
    EXPECT_NEAR(peakOf(straight(0, 0, 0, -1, 300)), std::sqrt(800), 1e-9);
    // A strong extruder is smoothed as all moves are, by 1500 and not by half of its own.
    limits.retracting = 8000;
    EXPECT_NEAR(peakOf(straight(0, 0, 0, -1, 300)), std::sqrt(1500), 1e-9);
    limits.cruise_ratio = 0.99;
    EXPECT_NEAR(peakOf(straight(0, 0, 1, 0, 300)), std::sqrt(30), 1e-9);
}

TEST(KlipperLookAhead, EachMoveBringsItsOwnLimitsToACorner) {
    MachineLimits fast = klipperLimits(4000);
    fast.corner_velocity = 9;
    const MachineLimits slow = klipperLimits(1000);
    const auto corner = [](const MachineLimits& first, const MachineLimits& second, double z = 0) {
        return plannedSteps({{straight(100, 0, 0, 0, 300), first}, {straight(0, 100, z, 0, 300), second}})
            .pieces[1]
            .speed.entry;
    };
    // d = scv^2 (sqrt 2 - 1) / a is of the time when the move was made: the lower scv of both counts, whichever is
    // first, and a change of acceleration alone counts nothing.
    EXPECT_NEAR(corner(fast, slow), 5, 1e-9);
    EXPECT_NEAR(corner(slow, fast), 5, 1e-9);
    EXPECT_NEAR(corner(klipperLimits(1000), klipperLimits(4000)), 5, 1e-9);
    // A move that z slows to a tenth of the machine's acceleration has the machine's d, but an acceleration of its own.
    MachineLimits weak = klipperLimits(1000);
    weak.acceleration[2] = 10;
    EXPECT_NEAR(corner(slow, weak, 10), 5 * std::sqrt(10 * std::hypot(10, 1) / 1000), 1e-9);
}

TEST(KlipperLookAhead, AMoveThatCanOnlyDecelerateCruisesAsTheOneBefore) {
    // 1 mm and then 0.5 mm at 1000 mm/s^2 from rest to rest. The smoothed profile peaks at v^2 = 500 * 1.5 in the first
    // move; the second one could begin at v^2 = 1000, but is clamped to the 750 of the cruise before it.
    const PlanList plan = soundKlipperPlan(klipperLimits(), {straight(1, 0, 0, 0, 300), straight(0.5, 0, 0, 0, 300)});
    ASSERT_EQ(plan.pieces.size(), 2U);
    EXPECT_NEAR(plan.pieces[0].speed.exit, std::sqrt(750), 1e-9);
    EXPECT_NEAR(plan.pieces[1].speed.entry, std::sqrt(750), 1e-9);
    EXPECT_NEAR(plan.pieces[1].speed.peak, std::sqrt(750), 1e-9);
    EXPECT_NEAR(plan.seconds, 2 * std::sqrt(750) / 1000 + 0.75 / std::sqrt(750), 1e-12);
}

TEST(KlipperLookAhead, ALineInPiecesTakesTheTimeOfTheLine) {
    std::vector<gcode::Move> pieces;
    for (int i = 0; i < 20000; ++i) pieces.push_back(straight(0.02, 0, 0, 0, 100));
    EXPECT_NEAR(soundKlipperPlan(klipperLimits(), pieces).seconds, 4.1, 1e-6);
}

}  // namespace
}  // namespace stratum::motion

#include "motion/planner.h"

#include "motions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
class PlannerOfRule : public testing::TestWithParam<CornerRule> {};
INSTANTIATE_TEST_SUITE_P(All, PlannerOfRule,
                         testing::Values(CornerRule::jerk, CornerRule::slicer_jerk, CornerRule::bambu_jerk,
                                         CornerRule::plan_jerk, CornerRule::junction_deviation,
                                         CornerRule::corner_velocity, CornerRule::marlin_jerk,
                                         CornerRule::reprap_jerk));

TEST_P(PlannerOfRule, SurvivesWhatNoMachineDoes) {
    for (const double acceleration : {1e-2, 1.0, 1e7})
        for (const double jerk : {0.0, 1e5}) {
            Motions program = randomMotions(GetParam(), 9, 2000);
            program.limits.printing = program.limits.travel = program.limits.retracting = acceleration;
            program.limits.jerk = {jerk, jerk, jerk, jerk};
            if (jerk > 0) program.limits.steps_per_mm = {80, 80, 400, 93};
            for (int i = 0; i < 500; ++i) {
                program.moves.push_back(straight(i % 2 == 0 ? 1 : -1, 0, 0, 0.01, 100));  // there and back
                program.moves.push_back(straight(0, 0, 0, 0, 100));
                program.moves.push_back(straight(1e-9, 0, 0, 0, 1e5));
            }
            expectSound(planned(program));
        }
}

TEST_P(PlannerOfRule, SplitMovesTakeTheSameTime) {
    Motions whole;
    whole.limits.rule = GetParam();
    Motions split = whole;
    for (int i = 0; i < 50; ++i) {
        const double x = 40 * std::cos(1.3 * i);
        const double y = 40 * std::sin(1.3 * i);
        whole.moves.push_back(straight(x, y, 0, 1, 100));
        for (int k = 0; k < 8; ++k) split.moves.push_back(straight(x / 8, y / 8, 0, 1.0 / 8, 100));
    }
    EXPECT_NEAR(planned(whole).seconds, planned(split).seconds, 1e-6 * planned(whole).seconds);
}

TEST(Planner, WaitsStopTheMachine) {
    const PlanList plan =
        planOf("M83\nG1 X10 F3000 E.1\nG4 P1500\nG1 X20 E.1\nG4 P2000\n", CornerRule::corner_velocity);
    ASSERT_EQ(plan.waits.size(), 2U);
    EXPECT_DOUBLE_EQ(plan.waits[0].seconds, 1.5);
    EXPECT_DOUBLE_EQ(plan.waits[1].seconds, 2);
    ASSERT_EQ(plan.pieces.size(), 2U);
    EXPECT_EQ(plan.pieces[0].speed.exit, 0);
    EXPECT_EQ(plan.pieces[1].speed.entry, 0);
    EXPECT_NEAR(plan.pieces[1].start, plan.pieces[0].speed.seconds() + 1.5, 1e-12);
    EXPECT_NEAR(plan.seconds, 3.5 + 2 * plan.pieces[0].speed.seconds(), 1e-12);
}

TEST(Planner, ASingleMoveIsItsTrapezoid) {
    // 100 mm at 50 mm/s, 1000 mm/s^2, from rest to rest.
    const PlanList plan = planOf("M83\nM204 P1000 T1000\nG1 X100 F3000 E5\n", CornerRule::corner_velocity);
    EXPECT_NEAR(plan.seconds, 0.1 + 97.5 / 50, 1e-12);
}

TEST(Planner, AMoveFromRestToRestHasItsClosedForm) {
    for (const double acceleration : {1e-3, 1.0, 1e3, 1e7})
        for (const double length : {1e-4, 1.0, 1e4}) {
            constexpr double kSpeed = 100;
            Motions program;
            program.limits.rule = CornerRule::corner_velocity;
            program.limits.speed.fill(1e9);
            program.limits.acceleration.fill(1e9);
            program.limits.printing = program.limits.travel = program.limits.retracting = acceleration;
            program.limits.cruise_ratio = 0;
            program.moves.push_back(straight(length, 0, 0, 0, kSpeed));
            const double exact = length >= kSpeed * kSpeed / acceleration ? length / kSpeed + kSpeed / acceleration
                                                                          : 2 * std::sqrt(length / acceleration);
            EXPECT_NEAR(planned(program).seconds / exact, 1, 64 * 0x1p-53) << length << " " << acceleration;
        }
}

TEST(Planner, TwoMovesAtARightAngle) {
    // Each 100 mm: from rest to 5 mm/s at the corner (square corner velocity), and from there to rest.
    const PlanList plan =
        planOf("M83\nSET_VELOCITY_LIMIT ACCEL=1000 SQUARE_CORNER_VELOCITY=5\nG1 X100 F3000 E5\nG1 Y100 E5\n",
               CornerRule::corner_velocity);
    ASSERT_EQ(plan.pieces.size(), 2U);
    EXPECT_NEAR(plan.pieces[0].speed.exit, 5, 1e-9);
    const double covered = (2500.0 + 2500 - 25) / 2000;
    EXPECT_NEAR(plan.seconds, 2 * (0.05 + 0.045 + (100 - covered) / 50), 1e-9);
}

TEST(Planner, ARuleOfAnotherFirmwareStopsTheMachineFirst) {
    PlanKeeper keeper;
    Planner planner(keeper);
    gcode::MachineLimits limits;
    limits.rule = CornerRule::jerk;
    planner.limits(limits);
    planner.move(straight(10, 0, 0, 0, 50));
    limits.rule = CornerRule::junction_deviation;
    planner.limits(limits);
    ASSERT_EQ(keeper.list.pieces.size(), 1U);
    EXPECT_EQ(keeper.list.pieces[0].speed.exit, 10);  // by the jerk of x
    planner.move(straight(10, 0, 0, 0, 50));
    planner.finish();
    ASSERT_EQ(keeper.list.pieces.size(), 2U);
    EXPECT_EQ(keeper.list.pieces[1].speed.entry, 0);
    EXPECT_EQ(planner.rule(), CornerRule::junction_deviation);
}

TEST(Planner, SpeedFactorsHold) {
    const PlanList plain = planOf("M83\nG1 X100 F600 E5\n");
    const PlanList twice = planOf("M83\nM220 S200\nG1 X100 F600 E5\n");
    EXPECT_NEAR(plain.pieces[0].speed.peak, 10, 1e-9);
    EXPECT_NEAR(twice.pieces[0].speed.peak, 20, 1e-9);
}

}  // namespace
}  // namespace stratum::motion

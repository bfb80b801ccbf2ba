#include "motion/planner.h"

#include "motions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::MachineLimits;

// The same moves for a planner and for the plain one below.
struct Program {
    MachineLimits limits;
    std::vector<gcode::Move> moves;
};

PlanList planned(const Program& program) {
    PlanKeeper keeper;
    Planner planner(keeper);
    planner.limits(program.limits);
    for (const gcode::Move& move : program.moves) planner.move(move);
    planner.finish();
    keeper.list.seconds = planner.seconds();
    return keeper.list;
}

// The whole program at once, nothing settled before the end is known: entry speeds squared.
struct Dense {
    std::vector<Segment> segments;
    std::vector<double> entry;
    std::vector<double> peak;  // squared, what smoothed look-ahead leaves
    double seconds = 0;
};

// Entry speeds for given gains: down to what the end allows, then up from the begin.
std::vector<double> reachable(const std::vector<double>& caps, const std::vector<double>& gains, double exit) {
    std::vector<double> entry = caps;
    for (std::size_t i = entry.size(); i-- > 0;)
        entry[i] = std::min(entry[i], (i + 1 < entry.size() ? entry[i + 1] : exit) + gains[i]);
    for (std::size_t i = 1; i < entry.size(); ++i) entry[i] = std::min(entry[i], entry[i - 1] + gains[i - 1]);
    return entry;
}

Dense denseOf(const Program& program) {
    const MachineLimits& limits = program.limits;
    Dense dense;
    for (const gcode::Move& move : program.moves)
        cutMove(move, limits, [&](const Segment& piece) { dense.segments.push_back(piece); });
    const auto& s = dense.segments;
    std::vector<double> caps;
    std::vector<double> gains;
    std::vector<double> smooth_gains;
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double cap = i == 0 ? restSpeed(s[0], limits) : cornerSpeed(s[i - 1], s[i], limits);
        caps.push_back(cap * cap);
        gains.push_back(2 * s[i].acceleration * s[i].length);
        const bool smooth = limits.rule == CornerRule::corner_velocity && s[i].travels;
        smooth_gains.push_back(gains.back() * (smooth ? 1 - limits.cruise_ratio : 1));
    }
    const double exit = std::pow(restSpeed(s.back(), limits), 2);
    dense.entry = reachable(caps, gains, exit);
    for (const Segment& piece : s) dense.peak.push_back(piece.speed * piece.speed);
    if (limits.rule == CornerRule::corner_velocity) {
        // Each hump of the smoothed speeds, from where they rise to where they no longer fall, has one peak.
        const std::vector<double> smooth = reachable(caps, smooth_gains, exit);
        const auto after = [&](std::size_t i) { return i + 1 < smooth.size() ? smooth[i + 1] : exit; };
        double shared = INFINITY;
        std::vector<std::size_t> falling;
        for (std::size_t i = s.size(); i-- > 0;) {
            const bool falls = smooth[i] >= after(i) + smooth_gains[i];
            const bool rises = after(i) >= smooth[i] + smooth_gains[i];
            if (falls) {
                falling.push_back(i);
            } else {
                if (!rises || !falling.empty())
                    shared = std::min(dense.peak[i], 0.5 * (smooth[i] + after(i) + smooth_gains[i]));
                for (const std::size_t later : falling) dense.peak[later] = std::min(dense.peak[later], shared);
                falling.clear();
                dense.peak[i] = std::min(dense.peak[i], shared);
            }
        }
    }
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double end = std::min(
            {i + 1 < s.size() ? dense.entry[i + 1] : exit, s[i].speed * s[i].speed, dense.entry[i] + gains[i]});
        dense.seconds += fastest(s[i].length, s[i].acceleration, dense.entry[i], dense.peak[i], end).seconds();
    }
    return dense;
}

Program randomProgram(CornerRule rule, unsigned seed, int moves) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    Program program;
    program.limits.rule = rule;
    program.limits.printing = program.limits.travel = std::pow(10, 2.5 + unit(random));
    double angle = 0;
    for (int i = 0; i < moves; ++i) {
        const double kind = unit(random);
        const double speed = std::pow(10, 1.5 + 0.8 * unit(random));
        if (kind > 0.95) {
            program.moves.push_back(straight(0, 0, 0, unit(random), speed));
        } else if (kind > 0.93) {
            program.moves.push_back(straight(0, 0, 0.2, 0, speed));
        } else {
            angle += kind > 0.7 ? 3 * unit(random) : 0.05 * unit(random);
            const double length = std::pow(10, unit(random) - (kind < -0.5 ? 1 : 0));
            program.moves.push_back(
                straight(length * std::cos(angle), length * std::sin(angle), 0, kind > 0.5 ? 0 : 0.04 * length, speed));
        }
    }
    return program;
}

class PlannerOfRule : public testing::TestWithParam<CornerRule> {};
INSTANTIATE_TEST_SUITE_P(All, PlannerOfRule,
                         testing::Values(CornerRule::jerk, CornerRule::slicer_jerk, CornerRule::plan_jerk,
                                         CornerRule::junction_deviation, CornerRule::corner_velocity));

TEST_P(PlannerOfRule, StreamsWhatAPassOverTheWholeProgramGives) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const Program program = randomProgram(GetParam(), seed, 20000);
        const PlanList plan = planned(program);
        const Dense dense = denseOf(program);
        expectSound(plan);
        ASSERT_EQ(plan.pieces.size(), dense.segments.size());
        for (std::size_t i = 0; i < plan.pieces.size(); ++i)
            ASSERT_NEAR(plan.pieces[i].speed.entry, std::sqrt(dense.entry[i]), 1e-9) << "piece " << i;
        EXPECT_NEAR(plan.seconds, dense.seconds, 1e-9 * dense.seconds);
    }
}

TEST_P(PlannerOfRule, SurvivesWhatNoMachineDoes) {
    for (const double acceleration : {1e-2, 1.0, 1e7})
        for (const double jerk : {0.0, 1e5}) {
            Program program = randomProgram(GetParam(), 9, 2000);
            program.limits.printing = program.limits.travel = program.limits.retracting = acceleration;
            program.limits.jerk = {jerk, jerk, jerk, jerk};
            for (int i = 0; i < 500; ++i) {
                program.moves.push_back(straight(i % 2 == 0 ? 1 : -1, 0, 0, 0.01, 100));  // there and back
                program.moves.push_back(straight(0, 0, 0, 0, 100));
                program.moves.push_back(straight(1e-9, 0, 0, 0, 1e5));
            }
            expectSound(planned(program));
        }
}

TEST_P(PlannerOfRule, SplitMovesTakeTheSameTime) {
    Program whole;
    whole.limits.rule = GetParam();
    Program split = whole;
    for (int i = 0; i < 50; ++i) {
        const double x = 40 * std::cos(1.3 * i);
        const double y = 40 * std::sin(1.3 * i);
        whole.moves.push_back(straight(x, y, 0, 1, 100));
        for (int k = 0; k < 8; ++k) split.moves.push_back(straight(x / 8, y / 8, 0, 1.0 / 8, 100));
    }
    EXPECT_NEAR(planned(whole).seconds, planned(split).seconds, 1e-6 * planned(whole).seconds);
}

TEST(Planner, KlipperCruisesPartOfShortMoves) {
    // 1 mm to and fro at 1000 mm/s^2: half the acceleration decides the peak, v^2 = a d / 2, of which half the way is
    // cruised.
    Program program;
    program.limits.rule = CornerRule::corner_velocity;
    program.limits.printing = program.limits.travel = 1000;
    for (int i = 0; i < 10; ++i) program.moves.push_back(straight(i % 2 == 0 ? 1 : -1, 0, 0, 0, 300));
    const PlanList plan = planned(program);
    for (const PlannedPiece& piece : plan.pieces) {
        EXPECT_NEAR(piece.speed.peak, std::sqrt(500), 1e-9);
        EXPECT_NEAR(piece.speed.cruising * piece.speed.peak, 0.5, 1e-9);
    }
    program.limits.cruise_ratio = 0;
    EXPECT_NEAR(planned(program).pieces[3].speed.peak, std::sqrt(1000), 1e-9);
}

TEST(Planner, LongBrakesAreBounded) {
    // So weak that braking takes more pieces than are kept: the plan is slower than the best, and still sound.
    Program program;
    program.limits.rule = CornerRule::junction_deviation;
    program.limits.printing = program.limits.travel = 0.1;
    for (std::size_t i = 0; i < 3 * Planner::kMostPending; ++i) program.moves.push_back(straight(0.01, 0, 0, 0, 400));
    const PlanList plan = planned(program);
    expectSound(plan);
    EXPECT_GE(plan.seconds, denseOf(program).seconds * (1 - 1e-12));
    EXPECT_LT(plan.seconds, 1.3 * denseOf(program).seconds);
}

TEST(Planner, WaitsStopTheMachine) {
    const PlanList plan = planOf("M83\nG1 X10 F3000 E.1\nG4 P1500\nG1 X20 E.1\nG4 S2\n", CornerRule::corner_velocity);
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

TEST(Planner, SpeedFactorsHold) {
    const PlanList plain = planOf("M83\nG1 X100 F600 E5\n");
    const PlanList twice = planOf("M83\nM220 S200\nG1 X100 F600 E5\n");
    EXPECT_NEAR(plain.pieces[0].speed.peak, 10, 1e-9);
    EXPECT_NEAR(twice.pieces[0].speed.peak, 20, 1e-9);
}

}  // namespace
}  // namespace stratum::motion

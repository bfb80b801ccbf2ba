#include "motion/marlin_look_ahead.h"

#include "motions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::MachineLimits;

MachineLimits queueLimits(CornerRule rule) {
    MachineLimits limits;
    limits.rule = rule;
    limits.printing = limits.travel = 1000;
    return limits;
}

PlanList soundPlan(const MachineLimits& limits, const std::vector<gcode::Move>& moves) {
    const PlanList plan = planned({limits, moves});
    expectSound(plan);
    return plan;
}

TEST(MarlinLookAhead, TheQueueLimitsTheSpeedOfShortMoves) {
    // Of 0.1 mm, and it must be possible to stop within the 14 that are known: v^2 = 2 a 1.4 mm.
    const PlanList plan = soundPlan(queueLimits(CornerRule::junction_deviation),
                                    std::vector<gcode::Move>(2000, straight(0.1, 0, 0, 0, 200)));
    double most = 0;
    for (const PlannedPiece& piece : plan.pieces) most = std::max(most, piece.speed.peak);
    EXPECT_NEAR(most, std::sqrt(2 * 1000 * 1.4), 1);
}

TEST(MarlinLookAhead, LongMovesAreAsIfAllWereKnown) {
    // 40 mm at 100 mm/s and 1000 mm/s^2, in one and in eight pieces.
    const std::vector<gcode::Move> whole(1, straight(40, 0, 0, 0, 100));
    const std::vector<gcode::Move> pieces(8, straight(5, 0, 0, 0, 100));
    for (const CornerRule rule : {CornerRule::junction_deviation, CornerRule::marlin_jerk})
        EXPECT_NEAR(soundPlan(queueLimits(rule), whole).seconds, soundPlan(queueLimits(rule), pieces).seconds, 1e-9);
}

TEST(MarlinLookAhead, MergedMovesShareTheirBlock) {
    MachineLimits limits = queueLimits(CornerRule::junction_deviation);
    limits.steps_per_mm = {80, 80, 400, 93};
    const PlanList plan = soundPlan(limits, std::vector<gcode::Move>(100, straight(0.05, 0, 0, 0, 20)));
    ASSERT_EQ(plan.pieces.size(), 100U);
    double length = 0;
    for (const PlannedPiece& piece : plan.pieces) {
        EXPECT_GT(piece.speed.seconds(), 0);
        length += piece.segment.length;
    }
    EXPECT_NEAR(length, 5, 1e-9);
    EXPECT_NEAR(plan.pieces.back().start + plan.pieces.back().speed.seconds(), plan.seconds, 1e-9);
}

}  // namespace
}  // namespace stratum::motion

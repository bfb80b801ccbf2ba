#include "motion/exact_look_ahead.h"

#include "motion/axis_limits.h"
#include "motion/corner.h"
#include "motions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace stratum::motion {
namespace {

using gcode::CornerRule;

// The whole program at once, nothing settled before the end is known: entry speeds squared.
struct Dense {
    std::vector<Segment> segments;
    std::vector<double> entry;
    double seconds = 0;
};

Dense denseOf(const Motions& program) {
    const gcode::MachineLimits& limits = program.limits;
    Dense dense;
    for (const gcode::Move& move : program.moves)
        cutMove(move, limits, [&](const Segment& piece) { dense.segments.push_back(piece); });
    for (std::size_t i = 0; i < dense.segments.size(); ++i) {
        Segment& segment = dense.segments[i];
        if (limits.rule == CornerRule::bambu_jerk)
            segment.speed =
                std::min(segment.speed, curveSpeed(i > 0 ? &dense.segments[i - 1] : nullptr, segment, limits));
        limitByAxes(limits, segment);
    }
    const auto& s = dense.segments;
    std::vector<double> gains;
    for (std::size_t i = 0; i < s.size(); ++i) {
        dense.entry.push_back(squared(i == 0 ? restSpeed(s[0], limits) : cornerSpeed(s[i - 1], s[i], limits)));
        gains.push_back(2 * s[i].acceleration * s[i].length);
    }
    // Down to what the end allows, then up from the begin.
    const double exit = squared(restSpeed(s.back(), limits));
    std::vector<double>& entry = dense.entry;
    for (std::size_t i = entry.size(); i-- > 0;)
        entry[i] = std::min(entry[i], (i + 1 < entry.size() ? entry[i + 1] : exit) + gains[i]);
    for (std::size_t i = 1; i < entry.size(); ++i) entry[i] = std::min(entry[i], entry[i - 1] + gains[i - 1]);
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double most = squared(s[i].speed);
        const double end = std::min({i + 1 < s.size() ? entry[i + 1] : exit, most, entry[i] + gains[i]});
        dense.seconds += fastest(s[i].length, s[i].acceleration, entry[i], most, end).seconds();
    }
    return dense;
}

class ExactOfRule : public testing::TestWithParam<CornerRule> {};
INSTANTIATE_TEST_SUITE_P(All, ExactOfRule,
                         testing::Values(CornerRule::jerk, CornerRule::slicer_jerk, CornerRule::bambu_jerk,
                                         CornerRule::plan_jerk, CornerRule::reprap_jerk));

TEST_P(ExactOfRule, StreamsWhatAPassOverTheWholeProgramGives) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const Motions program = randomMotions(GetParam(), seed, 20000);
        const PlanList plan = planned(program);
        const Dense dense = denseOf(program);
        expectSound(plan);
        ASSERT_EQ(plan.pieces.size(), dense.segments.size());
        for (std::size_t i = 0; i < plan.pieces.size(); ++i)
            ASSERT_NEAR(plan.pieces[i].speed.entry, std::sqrt(dense.entry[i]), 1e-9) << "piece " << i;
        EXPECT_NEAR(plan.seconds, dense.seconds, 1e-9 * dense.seconds);
    }
}

TEST(ExactLookAhead, LongBrakesAreBounded) {
    // So weak that braking takes more pieces than are kept: the plan is slower than the best, and still sound.
    Motions program;
    program.limits.rule = CornerRule::reprap_jerk;
    program.limits.printing = program.limits.travel = 0.1;
    for (std::size_t i = 0; i < 3 * ExactLookAhead::kMostPending; ++i)
        program.moves.push_back(straight(0.01, 0, 0, 0, 400));
    const PlanList plan = planned(program);
    expectSound(plan);
    EXPECT_GE(plan.seconds, denseOf(program).seconds * (1 - 1e-12));
    EXPECT_LT(plan.seconds, 1.3 * denseOf(program).seconds);
}

}  // namespace
}  // namespace stratum::motion

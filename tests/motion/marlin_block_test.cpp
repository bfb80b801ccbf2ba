#include "motion/marlin_look_ahead.h"

#include "motions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::MachineLimits;

MachineLimits blockLimits(CornerRule rule) {
    MachineLimits limits;
    limits.rule = rule;
    limits.speed = {1000, 1000, 1000, 1000};
    limits.acceleration.fill(100000);
    limits.printing = limits.travel = limits.retracting = 1000;
    limits.junction_deviation = 0.02;
    limits.jerk = {10, 10, 0.4, 5};
    return limits;
}

std::vector<MarlinBlock> blocksOf(const MachineLimits& limits, const std::vector<gcode::Move>& moves) {
    MarlinBlocks maker;
    std::vector<MarlinBlock> blocks;
    for (const gcode::Move& move : moves)
        cutMove(move, limits, [&](const Segment& segment) {
            if (const auto block = maker.next(segment, limits, blocks.empty())) blocks.push_back(*block);
        });
    return blocks;
}

double blockCorner(double turn, const MachineLimits& limits, double length = 100, double speed = 1000) {
    const auto blocks = blocksOf(limits, {straight(length, 0, 0, 0, speed),
                                          straight(length * std::cos(turn), length * std::sin(turn), 0, 0, speed)});
    return std::sqrt(blocks.at(1).entry_most);
}

constexpr double kQuarter = std::numbers::pi / 2;

TEST(MarlinBlock, JunctionDeviationByItsFormula) {
    const MachineLimits limits = blockLimits(CornerRule::junction_deviation);
    // v^2 = a d s / (1 - s), s the sine of half the angle inside the corner.
    for (const double turn : {0.3, 1.0, kQuarter, 2.0, 3.0}) {
        const double sine = std::sin((std::numbers::pi - turn) / 2);
        EXPECT_NEAR(blockCorner(turn, limits), std::sqrt(1000 * 0.02 * sine / (1 - sine)), 1e-9) << turn;
    }
    EXPECT_EQ(blockCorner(0, limits, 100, 60), 60);
    EXPECT_EQ(blockCorner(std::numbers::pi, limits), 0.05);
    EXPECT_EQ(blocksOf(limits, {straight(1, 0, 0, 0, 100)})[0].entry_most, 0);  // from rest
}

TEST(MarlinBlock, ShortPiecesOfACurveGoAsTheirCircleAllows) {
    // 0.5 mm and 0.1 rad: a radius of 5 mm. Marlin's angle is off by one percent at most.
    EXPECT_NEAR(blockCorner(0.1, blockLimits(CornerRule::junction_deviation), 0.5), std::sqrt(1000 * 5), 0.01 * 70);
}

TEST(MarlinBlock, ChordsOfAnArcGoAsItsRadiusAllows) {
    const MachineLimits limits = blockLimits(CornerRule::junction_deviation);
    gcode::Move arc;
    arc.delta = {10, 10, 0, 0};
    arc.center = {0, 10};
    arc.sweep = kQuarter;
    arc.speed = 200;
    const auto blocks = blocksOf(limits, {arc});
    ASSERT_EQ(blocks.size(), 18U);
    for (std::size_t i = 1; i + 1 < blocks.size(); ++i) EXPECT_NEAR(blocks[i].entry_most, 1000 * 10, 1e-6);
    // While one is the last that is known it may end as fast as the rest of the arc allows to brake.
    const double chord = 5 * std::numbers::pi / 18;
    EXPECT_NEAR(blocks[16].last_exit, 200 * 200, 1e-6);
    EXPECT_NEAR(blocksOf(blockLimits(CornerRule::marlin_jerk), {arc})[17].last_exit, 0.0025, 1e-12);
    MachineLimits weak = limits;
    weak.acceleration[0] = 1000;
    EXPECT_NEAR(blocksOf(weak, {arc})[16].last_exit, 2 * 1000 * chord, 1e-6);
}

TEST(MarlinBlock, StartSpeedIsTheJerkOverTheShareOfTheAxis) {
    const MachineLimits limits = blockLimits(CornerRule::marlin_jerk);
    const auto startOf = [&](const gcode::Move& move) { return std::sqrt(blocksOf(limits, {move})[0].entry_most); };
    EXPECT_NEAR(startOf(straight(10, 0, 0, 0, 100)), 10, 1e-9);
    EXPECT_NEAR(startOf(straight(10, 10, 0, 0, 100)), 10 * std::numbers::sqrt2, 1e-9);
    EXPECT_NEAR(startOf(straight(10, 0, 1, 0, 100)), 0.4 * std::hypot(10, 1), 1e-9);
    EXPECT_NEAR(startOf(straight(10, 0, 0, 0, 4)), 4, 1e-9);
}

TEST(MarlinBlock, ClassicJerkLimitsTheJumpOfEachAxis) {
    const MachineLimits limits = blockLimits(CornerRule::marlin_jerk);
    EXPECT_NEAR(blockCorner(std::numbers::pi / 3, limits, 100, 100), 10 / std::sin(std::numbers::pi / 3), 1e-9);
    EXPECT_NEAR(blockCorner(kQuarter, limits, 100, 100), 10, 1e-9);
    EXPECT_NEAR(blockCorner(std::numbers::pi, limits, 100, 100), 10, 1e-9);
    EXPECT_EQ(blockCorner(0, limits, 100, 100), 100);
}

TEST(MarlinBlock, MovesBelowSixStepsWaitForTheNext) {
    MachineLimits limits = blockLimits(CornerRule::junction_deviation);
    limits.steps_per_mm = {80, 80, 400, 93};
    // 4 steps each: every second one makes a block of 8.
    const std::vector<gcode::Move> moves(10, straight(0.05, 0, 0, 0, 100));
    const auto blocks = blocksOf(limits, moves);
    ASSERT_EQ(blocks.size(), 5U);
    for (const MarlinBlock& block : blocks) {
        EXPECT_DOUBLE_EQ(block.length, 0.1);
        EXPECT_EQ(block.steps, 8);
    }
    // Less than six steps of x beside more of E count nothing for the length.
    EXPECT_DOUBLE_EQ(blocksOf(limits, {straight(0.05, 0, 0, 1, 30)})[0].length, 1);
    // Ends are rounded to steps from the begin on: what is left over is not lost.
    double length = 0;
    for (const MarlinBlock& block : blocksOf(limits, std::vector<gcode::Move>(1000, straight(0.1234567, 0, 0, 0, 100))))
        length += block.length;
    EXPECT_NEAR(length, 123.4567, 0.5 / 80);
}

TEST(MarlinBlock, StepsMayBecomeKnownOrChange) {
    MachineLimits limits = blockLimits(CornerRule::junction_deviation);
    MarlinBlocks maker;
    Segment segment;
    segment.length = 10;
    segment.asked = 100;
    segment.direction = {1, 0, 0, 0};
    segment.travels = true;
    for (const double fine : {0.0, 1.0, 10.0, 1.0}) {
        limits.steps_per_mm = {80 * fine, 80 * fine, 400 * fine, 93 * fine};
        const auto block = maker.next(segment, limits, true);
        ASSERT_TRUE(block.has_value());
        EXPECT_NEAR(block->length, 10, 1e-12);
        EXPECT_EQ(block->steps, 800 * fine);
    }
    limits.steps_per_mm = {80, 0, 0, 0};  // not of all axes: not counted
    EXPECT_EQ(maker.next(segment, limits, true)->steps, 0);
}

TEST(MarlinBlock, NoBlockBeginsOrEndsBelow120StepsASecond) {
    MachineLimits limits = blockLimits(CornerRule::junction_deviation);
    for (const double fine : {1.0, 10.0}) {
        limits.steps_per_mm = {80 * fine, 80 * fine, 400 * fine, 93 * fine};
        const Trapezoid profile = blocksOf(limits, {straight(10, 0, 0, 0, 100)})[0].between(0, 0);
        EXPECT_NEAR(profile.entry, 1.5 / fine, 1e-9);
        EXPECT_NEAR(coveredBy(profile), 10, 1e-9);
        EXPECT_EQ(profile.peak, 100);
    }
}

TEST(MarlinBlock, AxesLimitSpeedAndAcceleration) {
    MachineLimits limits = blockLimits(CornerRule::junction_deviation);
    limits.speed = {300, 300, 15, 60};
    limits.acceleration = {3000, 3000, 100, 5000};
    limits.retracting = 7000;
    const auto blocks = blocksOf(limits, {straight(0, 0, 1, 0, 100), straight(0, 0, 0, 2, 100)});
    EXPECT_NEAR(blocks[0].speed, 15, 1e-9);
    EXPECT_NEAR(blocks[0].acceleration, 100, 1e-9);
    EXPECT_NEAR(blocks[1].speed, 60, 1e-9);
    EXPECT_NEAR(blocks[1].acceleration, 7000, 1e-9);  // M204 R, whatever M201 E says
}

}  // namespace
}  // namespace stratum::motion

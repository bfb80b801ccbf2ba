#include "motion/segment.h"

#include "motions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace stratum::motion {
namespace {

std::vector<Segment> piecesOf(const gcode::Move& move, const gcode::MachineLimits& limits = {}) {
    std::vector<Segment> pieces;
    cutMove(move, limits, [&](const Segment& piece) { pieces.push_back(piece); });
    return pieces;
}

TEST(Segment, AxesHoldSpeedAndAccelerationBack) {
    gcode::MachineLimits limits;
    limits.speed = {100, 50, 5, 20};
    limits.acceleration = {2000, 500, 100, 1000};
    const auto pieces = piecesOf(straight(3, 4, 0, 0, 500), limits);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_DOUBLE_EQ(pieces[0].length, 5);
    EXPECT_DOUBLE_EQ(pieces[0].speed, 50 / 0.8);
    EXPECT_DOUBLE_EQ(pieces[0].acceleration, 500 / 0.8);
    EXPECT_DOUBLE_EQ(pieces[0].asked, 500);
}

TEST(Segment, TheExtruderHoldsAMoveBack) {
    gcode::MachineLimits limits;
    limits.speed[3] = 1;
    EXPECT_DOUBLE_EQ(piecesOf(straight(10, 0, 0, 1, 100), limits)[0].speed, 10);
}

TEST(Segment, KindsOfMovesHaveAccelerationsOfTheirOwn) {
    gcode::MachineLimits limits;
    limits.printing = 100;
    limits.travel = 200;
    limits.retracting = 300;
    EXPECT_EQ(piecesOf(straight(1, 0, 0, 0.1, 10), limits)[0].acceleration, 100);
    EXPECT_EQ(piecesOf(straight(1, 0, 0, 0, 10), limits)[0].acceleration, 200);
    EXPECT_EQ(piecesOf(straight(0, 0, 0, -1, 10), limits)[0].acceleration, 300);
}

TEST(Segment, ArcsAreCutAlongTheirCircle) {
    gcode::Move move;  // a quarter of a circle of 10 mm, counter-clockwise about (0, 10), 3 mm up
    move.delta = {10, 10, 3, 0.5};
    move.center = {0, 10};
    move.sweep = std::numbers::pi / 2;
    move.speed = 40;
    const auto pieces = piecesOf(move);
    const double length = std::hypot(5 * std::numbers::pi, 3);
    ASSERT_EQ(pieces.size(), static_cast<std::size_t>(length));
    std::array<double, 4> sum{};
    double total = 0;
    for (const Segment& piece : pieces) {
        total += piece.length;
        for (std::size_t axis = 0; axis < 4; ++axis) sum[axis] += piece.direction[axis] * piece.length;
        EXPECT_NEAR(std::hypot(piece.direction[0], piece.direction[1], piece.direction[2]), 1, 1e-12);
    }
    EXPECT_NEAR(total, length, 1e-9);
    EXPECT_NEAR(sum[0], 10, 0.02);  // tangents, not chords
    EXPECT_NEAR(sum[1], 10, 0.02);
    EXPECT_NEAR(sum[2], 3, 1e-9);
    EXPECT_NEAR(sum[3], 0.5, 1e-9);
}

TEST(Segment, NothingGoesNowhere) {
    EXPECT_TRUE(piecesOf(straight(0, 0, 0, 0, 10)).empty());
    EXPECT_TRUE(piecesOf(straight(1e-14, 0, 0, 0, 10)).empty());
}

}  // namespace
}  // namespace stratum::motion

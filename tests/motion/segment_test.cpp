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

gcode::Move arcOf(double radius, double sweep, double z, double speed) {
    gcode::Move move;  // counter-clockwise about (0, radius)
    move.delta = {radius * std::sin(sweep), radius * (1 - std::cos(sweep)), z, 0.5};
    move.center = {0, radius};
    move.sweep = sweep;
    move.speed = speed;
    return move;
}

TEST(Segment, ArcsAreCutIntoChords) {
    const auto pieces = piecesOf(arcOf(10, std::numbers::pi / 2, 3, 40));
    ASSERT_EQ(pieces.size(), static_cast<std::size_t>(std::hypot(5 * std::numbers::pi, 3)));
    std::array<double, 4> sum{};
    const double angle = std::numbers::pi / 2 / static_cast<double>(pieces.size());
    for (const Segment& piece : pieces) {
        for (std::size_t axis = 0; axis < 4; ++axis) sum[axis] += piece.direction[axis] * piece.length;
        EXPECT_NEAR(std::hypot(piece.direction[0], piece.direction[1], piece.direction[2]), 1, 1e-12);
        EXPECT_NEAR(piece.length, std::hypot(20 * std::sin(angle / 2), 3.0 / static_cast<double>(pieces.size())),
                    1e-12);
        EXPECT_EQ(piece.radius, 10);
    }
    EXPECT_NEAR(sum[0], 10, 1e-12);
    EXPECT_NEAR(sum[1], 10, 1e-12);
    EXPECT_NEAR(sum[2], 3, 1e-12);
    EXPECT_NEAR(sum[3], 0.5, 1e-12);
    EXPECT_EQ(pieces.back().arc_rest, 0);
}

TEST(Segment, EachFirmwareHasItsOwnChords) {
    const auto count = [](gcode::CornerRule rule, const gcode::Move& move, double resolution = 1) {
        gcode::MachineLimits limits;
        limits.rule = rule;
        limits.arc_resolution = resolution;
        return piecesOf(move, limits).size();
    };
    using gcode::CornerRule;
    const gcode::Move quarter = arcOf(10, std::numbers::pi / 2, 0, 40);  // 15.7 mm
    EXPECT_EQ(count(CornerRule::corner_velocity, quarter), 15U);
    EXPECT_EQ(count(CornerRule::corner_velocity, quarter, 0.1), 157U);
    EXPECT_EQ(count(CornerRule::corner_velocity, quarter, 100), 1U);
    EXPECT_EQ(count(CornerRule::jerk, quarter), 15U);
    // Marlin 2: 72 to a circle at least, so 18 to a quarter; no longer than 1 mm; no shorter than 0.1 mm.
    EXPECT_EQ(count(CornerRule::marlin_jerk, quarter), 18U);
    EXPECT_EQ(count(CornerRule::junction_deviation, arcOf(20, std::numbers::pi / 2, 0, 40)), 32U);
    EXPECT_EQ(count(CornerRule::junction_deviation, arcOf(0.5, std::numbers::pi / 2, 0, 40)), 7U);
    // RepRapFirmware 3: chords of min(sqrt(8 r 0.005), v / 200) = 0.2 mm at 40 mm/s, 0.632 mm at any high speed.
    EXPECT_EQ(count(CornerRule::reprap_jerk, quarter), 79U);
    EXPECT_EQ(count(CornerRule::reprap_jerk, arcOf(10, std::numbers::pi / 2, 0, 300)), 25U);
}

TEST(Segment, NothingGoesNowhere) {
    EXPECT_TRUE(piecesOf(straight(0, 0, 0, 0, 10)).empty());
    EXPECT_TRUE(piecesOf(straight(1e-14, 0, 0, 0, 10)).empty());
}

}  // namespace
}  // namespace stratum::motion

#include "motion/axis_limits.h"

#include "motions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::MachineLimits;

Segment limited(const gcode::Move& move, const MachineLimits& limits) {
    std::vector<Segment> pieces;
    cutMove(move, limits, [&](const Segment& piece) { pieces.push_back(piece); });
    limitByAxes(limits, pieces.at(0));
    return pieces[0];
}

TEST(AxisLimits, HoldForTheShareOfEachAxis) {
    MachineLimits limits;
    limits.speed = {100, 50, 5, 20};
    limits.acceleration = {2000, 500, 100, 1000};
    const Segment piece = limited(straight(3, 4, 0, 0, 500), limits);
    EXPECT_DOUBLE_EQ(piece.length, 5);
    EXPECT_DOUBLE_EQ(piece.speed, 50 / 0.8);
    EXPECT_DOUBLE_EQ(piece.acceleration, 500 / 0.8);
    EXPECT_DOUBLE_EQ(piece.asked, 500);
    limits.speed[3] = 1;
    EXPECT_DOUBLE_EQ(limited(straight(10, 0, 0, 1, 100), limits).speed, 10);
}

TEST(AxisLimits, KindsOfMovesHaveAccelerationsOfTheirOwn) {
    MachineLimits limits;
    limits.printing = 100;
    limits.travel = 200;
    limits.retracting = 300;
    EXPECT_EQ(limited(straight(1, 0, 0, 0.1, 10), limits).acceleration, 100);
    EXPECT_EQ(limited(straight(1, 0, 0, 0, 10), limits).acceleration, 200);
    EXPECT_EQ(limited(straight(0, 0, 0, -1, 10), limits).acceleration, 300);
}

MachineLimits klipper() {
    MachineLimits limits;
    limits.rule = CornerRule::corner_velocity;
    limits.path_speed = 300;
    limits.printing = limits.travel = 3000;
    limits.speed[2] = 15;
    limits.acceleration[2] = 100;
    limits.extrude_only_speed = 40;
    limits.retracting = 800;
    return limits;
}

TEST(AxisLimits, KlipperLimitsZByItsShare) {
    const Segment up = limited(straight(3, 0, 4, 0, 500), klipper());
    EXPECT_DOUBLE_EQ(up.speed, 15 / 0.8);
    EXPECT_DOUBLE_EQ(up.acceleration, 100 / 0.8);
    const Segment level = limited(straight(3, 4, 0, 0.2, 500), klipper());
    EXPECT_EQ(level.speed, 300);  // neither x and y nor an extruder that feeds have a limit
    EXPECT_EQ(level.acceleration, 3000);
}

TEST(AxisLimits, KlipperLimitsTheExtruderWhereItDrawsBackOrMovesWithoutXAndY) {
    EXPECT_EQ(limited(straight(0, 0, 0, 2, 100), klipper()).speed, 40);
    EXPECT_EQ(limited(straight(0, 0, 0, 2, 100), klipper()).acceleration, 800);
    // Wiping: half a millimetre of filament per millimetre.
    const Segment wipe = limited(straight(2, 0, 0, -1, 100), klipper());
    EXPECT_DOUBLE_EQ(wipe.speed, 80);
    EXPECT_DOUBLE_EQ(wipe.acceleration, 1600);
    const Segment lift = limited(straight(0, 0, 1, 4, 100), klipper());
    EXPECT_DOUBLE_EQ(lift.speed, 10);
    EXPECT_DOUBLE_EQ(lift.acceleration, 100);
}

TEST(AxisLimits, RepRapFirmwareKnowsM204InTheBedPlaneOnly) {
    MachineLimits limits;
    limits.rule = CornerRule::reprap_jerk;
    limits.acceleration = {3000, 3000, 20, 500};
    limits.speed = {300, 300, 10, 60};
    limits.printing = 1000;
    limits.travel = 2000;
    limits.retracting = 1;
    EXPECT_EQ(limited(straight(10, 0, 0, 0.3, 100), limits).acceleration, 1000);
    EXPECT_EQ(limited(straight(10, 0, 0, 0, 100), limits).acceleration, 2000);
    EXPECT_EQ(limited(straight(0, 0, 1, 0, 100), limits).acceleration, 20);
    EXPECT_EQ(limited(straight(0, 0, 0, -1, 100), limits).acceleration, 500);
    EXPECT_EQ(limited(straight(10, 0, 0, 0, 0.01), limits).speed, 0.5);
    // Pressure advance of 0.1 s: the extruder jumps by 0.1 a of its share, at most by its jerk.
    limits.pressure_advance = 0.1;
    limits.jerk[3] = 5;
    EXPECT_NEAR(limited(straight(10, 0, 0, 1, 50), limits).acceleration, 5 / 0.1 / 0.1, 1e-9);
}

}  // namespace
}  // namespace stratum::motion

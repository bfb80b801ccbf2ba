#include "gcode/machine/belt.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stratum::gcode {
namespace {

// A box of 10 mm, as its corners lie in the world, is sliced by hand: in the gantry's plane (45 degrees to the belt)
// y is how far up the nozzle goes, z how far the belt has moved.
TEST(Belt, KeepsDistancesAndHands) {
    const Belt belt(45);
    const double diagonal = 10 * std::sqrt(2.0);
    const Point corner = belt.place({0, 0, 0});
    const Point beside = belt.place({10, 0, 0});
    const Point behind = belt.place({0, 0, 10});        // 10 mm along the belt
    const Point above = belt.place({0, diagonal, 10});  // straight up: the belt runs under the leaning nozzle
    const auto distance = [](const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); };
    for (const Point& point : {beside, behind, above}) EXPECT_NEAR(distance(corner, point), 10, 1e-12);
    EXPECT_NEAR(distance(beside, behind), diagonal, 1e-12);
    EXPECT_NEAR(distance(behind, above), diagonal, 1e-12);
    EXPECT_NEAR(distance(above, beside), diagonal, 1e-12);
    // x, then back along the belt, then up: a right hand's.
    const Point a{behind.x - corner.x, behind.y - corner.y, behind.z - corner.z};
    const Point b{above.x - corner.x, above.y - corner.y, above.z - corner.z};
    EXPECT_LT(a.y * b.z - a.z * b.y, 0);  // (a x b) points to -x, as (back) x (up) does
}

TEST(Belt, LayersAreLevelAndAsHighAsTheyAre) {
    ReadOptions options;
    options.belt_angle = 45;
    const Toolpath toolpath = readProgram(
        "M83\nG1 Z.2828427\nG1 X9 E1\nG1 Z.5656854\nG1 X0 E1\nG3 X0 Y2 I0 J1 E1\nG1 Z.8485281\nG1 X9 E1\n", options);
    ASSERT_EQ(toolpath.beads.size(), 4U);
    EXPECT_NEAR(toolpath.beads[0].z1, 0.2, 1e-6);
    EXPECT_NEAR(toolpath.beads[1].z1, 0.4, 1e-6);
    EXPECT_NEAR(toolpath.beads[1].y1, -0.4, 1e-6);
    EXPECT_NEAR(toolpath.arcs.at(0).center_y, 0.6, 1e-6);
    EXPECT_NEAR(toolpath.beads[3].y0, 1.4, 1e-6);
    EXPECT_EQ(toolpath.layer_count, 3U);
    EXPECT_NEAR(static_cast<double>(toolpath.runOf(toolpath.beads[1]).height), 0.2, 1e-4);
    EXPECT_NEAR(beadVolume(toolpath), toolpath.extruded_mm3, 1e-4);
}

TEST(Belt, AnglesThatNoBeltHas) {
    for (const double angle : {0.0, 90.0, -45.0, 1e9, std::nan("")}) {
        ReadOptions options;
        options.belt_angle = angle;
        EXPECT_THROW(readProgram("M83\nG1 Z1\nG1 X9 E1\n", options), UsageError) << angle;
    }
}

TEST(Belt, APrinterWithABeltIsSaid) {
    const std::string program = ";TARGET_MACHINE.NAME:Creality CR-30\nM83\nG1 Z.2\nG1 X9 E1\n";
    EXPECT_EQ(warningCount(readProgram(program), "CR-30 prints on a belt"), 1U);
    ReadOptions options;
    options.belt_angle = 45;
    EXPECT_EQ(warningCount(readProgram(program, options), "belt"), 0U);
    EXPECT_EQ(warningCount(readProgram("; Bed type: belt\nM83\nG1 Z.2\nG1 X9 E1\n"), "prints on a belt"), 1U);
}

// ideaMaker's HEIGHT is how far the belt goes, HEIGHT-BELT how thick the layer is.
TEST(Belt, HeightsAreAcrossTheLayers) {
    const Toolpath toolpath = readProgram(
        ";Belt Printer: 1\n;Belt Gantry Angle: 45\nM83\n"
        ";LAYER:0\n;HEIGHT:0.800\n;HEIGHT-BELT:0.566\nG1 Z.8\n;TYPE:TOP-SURFACE\nG1 X9 E1\n"
        ";LAYER:1\n;HEIGHT:0.566\n;HEIGHT-BELT:0.400\nG1 Z1.366\nG1 X0 E1\n");
    ASSERT_EQ(toolpath.beads.size(), 2U);
    EXPECT_NEAR(static_cast<double>(toolpath.runOf(toolpath.beads[0]).height), 0.566, 1e-6);
    EXPECT_NEAR(static_cast<double>(toolpath.runOf(toolpath.beads[1]).height), 0.4, 1e-6);
    EXPECT_NEAR(toolpath.beads[1].z1, 0.966, 1e-3);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[0]).feature, Feature::top_infill);
    EXPECT_EQ(warningCount(toolpath, "unknown feature"), 0U);
}

// ideaMaker states the angle.
TEST(Belt, AStatedAngleIsTaken) {
    const std::string stated = ";Belt Printer: 1\n;Belt Gantry Angle: 35\n";
    const std::string program = "M83\nG1 Z.2\nG1 X9 E1\n";
    const Toolpath toolpath = readProgram(stated + program);
    EXPECT_EQ(toolpath.belt_angle, 35);
    EXPECT_EQ(warningCount(toolpath, "belt"), 0U);
    EXPECT_NEAR(toolpath.beads.at(0).z1, 0.2 * std::sin(35 * std::numbers::pi / 180), 1e-9);
    ReadOptions options;
    options.belt_angle = 45;
    EXPECT_EQ(readProgram(stated + program, options).belt_angle, 45);
    EXPECT_EQ(readProgram(program).belt_angle, 0);
    const Toolpath upright = readProgram(";Belt Printer: 1\n;Belt Gantry Angle: 90\n" + program);
    EXPECT_EQ(upright.belt_angle, 0);
    EXPECT_EQ(warningCount(upright, "prints on a belt"), 1U);
    EXPECT_EQ(readProgram(";Belt Printer: 0\n;Belt Gantry Angle: 45\n" + program).belt_angle, 0);
}

}  // namespace
}  // namespace stratum::gcode

#include "deposit/limits/limit_files.h"

#include "deposit/limits/printer_files.h"

#include <fmt/format.h>

#include <numbers>

namespace stratum::deposit {
namespace {

using gcode::Limit;
using gcode::LimitOrigin;
using gcode::ofAxis;

constexpr const char* kMachine =
    "[printer]\nkinematics: corexy\nmax_velocity: 400\nmax_accel = 8000 # measured\nsquare_corner_velocity: 7\n"
    "minimum_cruise_ratio: 0.25\nmax_z_velocity: 20\nmax_z_accel: 350\n\n"
    "[extruder]\nnozzle_diameter: 0.4\nfilament_diameter: 1.75\nmax_extrude_only_velocity: 90\n"
    "max_extrude_only_accel: 4500\ninstantaneous_corner_velocity: 2\npressure_advance: 0.04\n"
    "[gcode_arcs]\nresolution: 0.2\n";

TEST(KlipperLimits, AreThoseOfTheFile) {
    const PrinterFiles files;
    const gcode::PrinterLimits printer = files.read(kMachine);
    const gcode::MachineLimits& limits = printer.limits;
    EXPECT_EQ(printer.firmware, gcode::Firmware::klipper);
    EXPECT_EQ(limits.rule, gcode::CornerRule::corner_velocity);
    EXPECT_EQ(limits.arcs, gcode::ArcRule::klipper);
    EXPECT_EQ(limits.path_speed, 400);
    EXPECT_EQ(limits.printing, 8000);
    EXPECT_EQ(limits.travel, 8000);
    EXPECT_EQ(limits.corner_velocity, 7);
    EXPECT_EQ(limits.cruise_ratio, 0.25);
    EXPECT_EQ(limits.speed[2], 20);
    EXPECT_EQ(limits.acceleration[2], 350);
    EXPECT_EQ(limits.extrude_only_speed, 90);
    EXPECT_EQ(limits.retracting, 4500);
    EXPECT_EQ(limits.extruder_corner_velocity, 2);
    EXPECT_EQ(limits.arc_resolution, 0.2);
    EXPECT_EQ(limits.pressure_advance, 0.04);
    EXPECT_EQ(placeOf(printer, Limit::path_speed), "printer:3");
    EXPECT_EQ(placeOf(printer, Limit::arc_resolution), "printer:18");
}

// toolhead.py and extruder.py: 5 mm/s, half, the whole machine's for z, 1 mm/s, 1 mm, and for E alone the machine's
// times 4 nozzle^2 over the section of the filament.
TEST(KlipperLimits, WhatTheFileLeavesOutIsKlippersDefault) {
    const PrinterFiles files;
    const gcode::PrinterLimits printer = files.read(
        "[printer]\nkinematics: cartesian\nmax_velocity: 300\nmax_accel: 3000\n[extruder]\nnozzle_diameter: 0.4\n"
        "filament_diameter: 1.75\n");
    const gcode::MachineLimits& limits = printer.limits;
    EXPECT_EQ(limits.corner_velocity, 5);
    EXPECT_EQ(limits.cruise_ratio, 0.5);
    EXPECT_EQ(limits.speed[2], 300);
    EXPECT_EQ(limits.acceleration[2], 3000);
    EXPECT_EQ(limits.extruder_corner_velocity, 1);
    EXPECT_EQ(limits.arc_resolution, 1);
    const double ratio = 4 * 0.16 / (std::numbers::pi * 1.75 * 1.75 / 4);
    EXPECT_NEAR(limits.extrude_only_speed, 300 * ratio, 1e-9);
    EXPECT_NEAR(limits.retracting, 3000 * ratio, 1e-9);
    for (const Limit limit : {Limit::corner_velocity, Limit::cruise_ratio, ofAxis(Limit::speed, 2), Limit::retracting})
        EXPECT_EQ(printer.origins[limit].kind, LimitOrigin::Kind::firmware);
    // An older option, where the newer is missing.
    EXPECT_EQ(
        files.read("[printer]\nmax_velocity: 300\nmax_accel: 3000\nmax_accel_to_decel: 1500\n").limits.cruise_ratio,
        0.5);
    EXPECT_EQ(
        files.read("[printer]\nmax_velocity: 300\nmax_accel: 3000\nmax_accel_to_decel: 9000\n").limits.cruise_ratio, 0);
}

TEST(KlipperLimits, WithoutAnExtruderItsLimitsAreAssumed) {
    const PrinterFiles files;
    const gcode::PrinterLimits printer = files.read("[printer]\nmax_velocity: 300\nmax_accel: 3000\n");
    EXPECT_EQ(printer.origins[Limit::extrude_only_speed].kind, LimitOrigin::Kind::assumed);
    EXPECT_EQ(printer.origins[Limit::retracting].kind, LimitOrigin::Kind::assumed);
}

TEST(KlipperLimits, RefusesWhatKlipperRefuses) {
    const PrinterFiles files;
    const auto with = [](std::string_view line) {
        return fmt::format("[printer]\nmax_velocity: 300\nmax_accel: 3000\n{}\n", line);
    };
    for (const char* value : {"0", "-5", "1e300", "nan", "inf", "fast", "", "300 mm/s", "1e", "3,5", "300\n  400"}) {
        const std::string refusal = files.refusal(fmt::format("[printer]\nmax_velocity: {}\nmax_accel: 3000\n", value));
        EXPECT_TRUE(says(refusal, "printer:2: max_velocity is"));
    }
    EXPECT_TRUE(says(files.refusal(with("square_corner_velocity: -1")), "printer:4: square_corner_velocity is '-1'"));
    EXPECT_TRUE(says(files.refusal(with("minimum_cruise_ratio: 1")), "printer:4: minimum_cruise_ratio"));
    EXPECT_TRUE(
        says(files.refusal(with("max_z_velocity: 301")), "printer:4: max_z_velocity is 301; Klipper takes no more"));
    EXPECT_TRUE(says(files.refusal(with("max_z_accel: 0")), "printer:4: max_z_accel"));
    EXPECT_TRUE(says(files.refusal(with("[gcode_arcs]\nresolution: 0")), "printer:5: resolution"));
    EXPECT_TRUE(says(files.refusal(with("[extruder]\nfilament_diameter: 1.75")), "[extruder] has no nozzle_diameter"));
    EXPECT_TRUE(
        says(files.refusal(with("[extruder]\nnozzle_diameter: 0\nfilament_diameter: 1.75")), "printer:5: nozzle"));
    EXPECT_TRUE(says(files.refusal("[printer]\nmax_accel: 3000\n"), "[printer] has no max_velocity"));
    EXPECT_TRUE(says(files.refusal("[extruder]\n"), "[printer] has no max_velocity"));
}

}  // namespace
}  // namespace stratum::deposit

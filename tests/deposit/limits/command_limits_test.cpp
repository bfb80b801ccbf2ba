#include "deposit/limits/limit_files.h"

#include "deposit/limits/printer_files.h"

#include <array>

namespace stratum::deposit {
namespace {

using gcode::CornerRule;
using gcode::Firmware;
using gcode::Limit;
using gcode::LimitOrigin;
using gcode::ofAxis;
using Axes = std::array<double, gcode::kMotionAxes>;

// As a host writes down what Marlin 2 answers.
constexpr const char* kMarlin2 =
    "Send: M503\nRecv: echo:; Linear Units:\nRecv: echo:  G21 ; (mm)\nRecv: echo:; Steps per unit:\n"
    "Recv: echo:  M92 X80.00 Y80.50 Z400.00 E93.00\nRecv: echo:  M92 T1 E140\n"
    "Recv: echo:; Max feedrates (units/s):\nRecv: echo:  M203 X300.00 Y301.00 Z15.00 E60.00\n"
    "Recv: echo:; Max Acceleration (units/s2):\nRecv: echo:  M201 X3000.00 Y3100.00 Z100.00 E5000.00\n"
    "Recv: echo:; Acceleration (units/s2) (P<print-accel> R<retract-accel> T<travel-accel>):\n"
    "Recv: echo:  M204 P1500.00 R1600.00 T2000.00\n";

TEST(CommandLimits, AReportOfMarlin2) {
    const PrinterFiles files;
    const std::string report = std::string(kMarlin2) + "Recv: echo:  M205 B20000.00 S1.00 T2.00 J0.02\r\nRecv: ok\n";
    const gcode::PrinterLimits printer = files.read(report);
    EXPECT_EQ(printer.firmware, Firmware::marlin);
    EXPECT_EQ(printer.limits.rule, CornerRule::junction_deviation);
    EXPECT_EQ(printer.limits.arcs, gcode::ArcRule::marlin);
    EXPECT_EQ(printer.limits.steps_per_mm, (Axes{80, 80.5, 400, 93}));
    EXPECT_EQ(printer.limits.speed, (Axes{300, 301, 15, 60}));
    EXPECT_EQ(printer.limits.acceleration, (Axes{3000, 3100, 100, 5000}));
    EXPECT_EQ(printer.limits.printing, 1500);
    EXPECT_EQ(printer.limits.retracting, 1600);
    EXPECT_EQ(printer.limits.travel, 2000);
    EXPECT_EQ(printer.limits.least_printing_speed, 1);
    EXPECT_EQ(printer.limits.least_travel_speed, 2);
    EXPECT_EQ(printer.limits.junction_deviation, 0.02);
    EXPECT_EQ(placeOf(printer, Limit::speed), "printer:8");
    EXPECT_EQ(printer.origins[Limit::jerk].kind, LimitOrigin::Kind::assumed);
}

TEST(CommandLimits, JerkIsByTheRuleOfTheVersion) {
    const PrinterFiles files;
    const gcode::PrinterLimits marlin_2 =
        files.read(std::string(kMarlin2) + "echo:  M205 B20000 S0 T0 X8.00 Y9.00 Z0.40 E5.00\n");
    EXPECT_EQ(marlin_2.limits.rule, CornerRule::marlin_jerk);
    EXPECT_EQ(marlin_2.limits.jerk, (Axes{8, 9, 0.4, 5}));
    // Marlin 1: headings that are no comments, one jerk for the plane.
    const gcode::PrinterLimits marlin_1 = files.read(
        "echo:Steps per unit:\necho:  M92 X80 Y80 Z400 E95\necho:Advanced variables:\necho:  M205 S0 T0 B20000 X12 "
        "Z0.4 "
        "E5\n");
    EXPECT_EQ(marlin_1.limits.rule, CornerRule::jerk);
    EXPECT_EQ(marlin_1.limits.jerk, (Axes{12, 12, 0.4, 5}));
    // Inches.
    EXPECT_EQ(files.read("echo:  G20 ; (in)\necho:  M203 X10 Y10 Z1 E1\n").limits.speed, (Axes{254, 254, 25.4, 25.4}));
}

constexpr const char* kDuet =
    "; Drives\nM569 P0 S1\nM584 X0 Y1 Z2 E3:4\nM92 X80.00 Y80.00 Z400.00 E420:430   ; steps\n"
    "M566 X900.00 Y600.00 Z12.00 E120.00:60 P1\nM203 X18000.00 Y18000 Z900 E3600:60\nM201 X3000 Y3100 Z20 E250:1\n"
    "M201.1 X100\nM98 P\"M203 X1\"\nM204 P1500 T2000\n";

TEST(CommandLimits, AConfigOfRepRapFirmware) {
    const PrinterFiles files;
    const gcode::PrinterLimits printer = files.read(kDuet);
    EXPECT_EQ(printer.firmware, Firmware::reprap);
    EXPECT_EQ(printer.limits.rule, CornerRule::reprap_jerk);
    EXPECT_EQ(printer.limits.jerk, (Axes{15, 10, 0.2, 2}));  // mm/min in the file
    EXPECT_EQ(printer.limits.jerk_policy, 1);
    EXPECT_EQ(printer.limits.speed, (Axes{300, 300, 15, 60}));
    EXPECT_EQ(printer.limits.acceleration, (Axes{3000, 3100, 20, 250}));
    EXPECT_EQ(printer.limits.steps_per_mm[3], 420);
    EXPECT_EQ(printer.limits.printing, 1500);
    EXPECT_EQ(printer.limits.travel, 2000);
    EXPECT_EQ(placeOf(printer, Limit::jerk), "printer:5");
    EXPECT_EQ(files.read("M584 X0\nM203 S1 X300 I2\nM205 X7\n").limits.speed[0], 300);
    EXPECT_EQ(files.read("M584 X0\nM203 S1 X300 I2\nM205 X7\n").limits.least_travel_speed, 2);
    EXPECT_EQ(files.read("M584 X0\nM203 S1 X300 I2\nM205 X7\n").limits.jerk[0], 7);
}

// Configuration.h of RepRapFirmware 3.5.
TEST(CommandLimits, WhatAConfigLeavesOutIsRepRapFirmwaresDefault) {
    const PrinterFiles files;
    const gcode::PrinterLimits printer = files.read("M566 X900\n");
    EXPECT_EQ(printer.limits.speed, (Axes{100, 100, 20, 100}));
    EXPECT_EQ(printer.limits.acceleration, (Axes{1000, 1000, 200, 500}));
    EXPECT_EQ(printer.limits.jerk, (Axes{15, 15, 10, 5}));
    EXPECT_EQ(printer.origins[ofAxis(Limit::jerk, 1)].kind, LimitOrigin::Kind::firmware);
    EXPECT_EQ(printer.origins[Limit::jerk].kind, LimitOrigin::Kind::printer);
}

TEST(CommandLimits, RefusesWhatNoMachineHas) {
    const PrinterFiles files;
    EXPECT_TRUE(says(files.refusal("M566 X900\nM203 X0\n"), "printer:2: M203 X is 0; expected a number from 0.001"));
    EXPECT_TRUE(says(files.refusal("M566 X-900\n"), "printer:1: M566 X is -15"));
    EXPECT_TRUE(says(files.refusal("M566 X900\n\nM201 Z1000000000000\n"), "printer:3: M201 Z is 1e+12"));
    EXPECT_TRUE(says(files.refusal("echo: M92 X80\necho: M204 P\n"), "printer:2: M204 P has no number"));
    EXPECT_TRUE(says(files.refusal("M566 X{var.jerk}\n"), "expressions are not evaluated"));
    EXPECT_TRUE(says(files.refusal("echo: M203 Xfast\n"), "M203 X has no number"));
    EXPECT_TRUE(says(files.refusal("M203 X300\nG1 X10 E5\n"), "printer:2: a move that prints"));
    EXPECT_TRUE(says(files.refusal("Dear printer, be fast.\n"), "no limit of a printer in it; expected Klipper's"));
    EXPECT_TRUE(says(files.refusal(std::string(2000000, '\n')), "too many for a printer"));
}

}  // namespace
}  // namespace stratum::deposit

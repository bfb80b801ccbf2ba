#include "gcode/printer/machine_limits.h"

#include "program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr const char* kKlipperSettings =
    "; gcode_flavor = klipper\n; machine_max_speed_x = 500,200\n; machine_max_speed_y = 400\n"
    "; machine_max_speed_z = 20\n; machine_max_speed_e = 30\n; machine_max_acceleration_x = 9000\n"
    "; machine_max_acceleration_z = 500\n; machine_max_acceleration_e = 5000\n"
    "; machine_max_acceleration_extruding = 7000\n; machine_max_acceleration_travel = 8000\n"
    "; machine_max_jerk_x = 9\n; machine_min_travel_rate = 3\n";

PrinterLimits klipperPrinter() {
    PrinterLimits printer;
    printer.name = "printer.cfg";
    printer.firmware = Firmware::klipper;
    printer.limits.rule = CornerRule::corner_velocity;
    printer.set(Limit::path_speed, 300, LimitOrigin::Kind::printer, "printer.cfg:2");
    printer.set(Limit::printing, 3000, LimitOrigin::Kind::printer, "printer.cfg:3");
    printer.set(Limit::travel, 3000, LimitOrigin::Kind::printer, "printer.cfg:3");
    printer.set(ofAxis(Limit::speed, 2), 300, LimitOrigin::Kind::firmware, "Klipper's default");
    return printer;
}

TEST(MachineLimits, ForKlipperSettingsAreAnAssumption) {
    const MachineSettings read = readMachineSettings(kKlipperSettings, CornerRule::automatic);
    EXPECT_EQ(read.limits.rule, CornerRule::corner_velocity);  // with or without jerk
    EXPECT_EQ(read.limits.path_speed, 400);
    EXPECT_EQ(read.limits.printing, 7000);
    EXPECT_EQ(read.limits.travel, 7000);  // Klipper has one
    EXPECT_EQ(read.limits.speed[2], 20);
    EXPECT_EQ(read.limits.acceleration[2], 500);
    EXPECT_EQ(read.limits.extrude_only_speed, 30);
    EXPECT_EQ(read.limits.retracting, 5000);
    EXPECT_TRUE(std::isinf(read.limits.speed[0]) && std::isinf(read.limits.acceleration[3]));
    EXPECT_EQ(read.limits.least_travel_speed, 0);
    EXPECT_EQ(read.most_printing, 0);  // M204 is not capped
    EXPECT_EQ(read.origins[Limit::path_speed].kind, LimitOrigin::Kind::setting);
    EXPECT_EQ(read.origins[Limit::path_speed].place, "machine_max_speed_y");
    EXPECT_EQ(read.origins[Limit::corner_velocity].kind, LimitOrigin::Kind::assumed);
    // Without any: those of Klipper's samples.
    const MachineSettings none = readMachineSettings("; gcode_flavor = klipper\n", CornerRule::automatic);
    EXPECT_EQ(none.limits.path_speed, 300);
    EXPECT_EQ(none.limits.printing, 3000);
    EXPECT_EQ(none.origins[Limit::printing].kind, LimitOrigin::Kind::assumed);
}

TEST(MachineLimits, OfKisslicer) {
    const MachineSettings settings =
        readMachineSettings("; z_speed_mm_per_s = 3.5\n; xy_accel_mm_per_s_per_s = 3000\nG28\n", CornerRule::automatic);
    EXPECT_EQ(settings.limits.rule, CornerRule::jerk);
    EXPECT_EQ(settings.limits.printing, 3000);
    EXPECT_EQ(settings.limits.travel, 3000);
    EXPECT_EQ(settings.limits.speed[2], MachineLimits().speed[2]);  // asked for, no limit
    EXPECT_EQ(settings.origins[Limit::printing].place, "xy_accel_mm_per_s_per_s");
}

TEST(MachineLimits, TheSlicersRuleIsThereByName) {
    const MachineSettings read = readMachineSettings(kKlipperSettings, CornerRule::slicer_jerk);
    EXPECT_EQ(read.limits.speed[0], 500);
    EXPECT_EQ(read.limits.travel, 8000);
    EXPECT_EQ(read.most_travel, 8000);
    EXPECT_EQ(read.origins[Limit::jerk].place, "machine_max_jerk_x");
}

TEST(MachineLimits, AUsersLimitsWin) {
    const MachineSettings read =
        readMachineSettings(kKlipperSettings, CornerRule::automatic, klipperPrinter(), Firmware::klipper);
    EXPECT_EQ(read.limits.path_speed, 300);
    EXPECT_EQ(read.limits.printing, 3000);
    EXPECT_EQ(read.limits.speed[2], 300);
    EXPECT_EQ(read.origins[Limit::path_speed].place, "printer.cfg:2");
    EXPECT_EQ(read.origins[Limit::path_speed].value, 300);
    EXPECT_TRUE(std::isinf(read.limits.speed[0]) && std::isinf(read.limits.speed[3]));
    // What it leaves open is assumed as ever.
    EXPECT_EQ(read.limits.extrude_only_speed, 30);
    EXPECT_EQ(read.origins[Limit::extrude_only_speed].kind, LimitOrigin::Kind::setting);
    EXPECT_EQ(
        readMachineSettings("", CornerRule::automatic, klipperPrinter(), Firmware::klipper).limits.extrude_only_speed,
        0.2661 * 300);
    EXPECT_TRUE(read.rule_chosen);
    // A few of them, for Marlin: the others stay the file's, and M204 is not capped by what they replace.
    PrinterLimits some;
    some.limits.rule = CornerRule::automatic;
    some.set(Limit::printing, 900, LimitOrigin::Kind::printer, "my.json:1");
    const MachineSettings marlin = readMachineSettings(
        "; machine_max_jerk_x = 9\n; machine_max_acceleration_extruding = 500\n; machine_max_acceleration_travel = "
        "600\n",
        CornerRule::automatic, some);
    EXPECT_EQ(marlin.limits.rule, CornerRule::slicer_jerk);
    EXPECT_EQ(marlin.limits.printing, 900);
    EXPECT_EQ(marlin.limits.jerk[0], 9);
    EXPECT_EQ(marlin.most_printing, 0);
    EXPECT_EQ(marlin.most_travel, 600);
}

class LastLimits : public MotionSink {
public:
    void limits(const MachineLimits& limits) override { last = limits; }
    void move(const Move&) override {}
    void wait(double seconds) override { waits.push_back(seconds); }
    void origin(const LimitOrigins& origins) override { from = origins; }

    MachineLimits last;
    LimitOrigins from;
    std::vector<double> waits;
};

TEST(MachineLimits, AWaitAfterM400IsThePrintersOrNone) {
    constexpr const char* kProgram = "M83\nG1 X1 E1\nM400\nG1 X2 E1\nM109 S200\n";
    LastLimits log;
    ReadOptions options;
    options.motion = &log;
    options.printer = klipperPrinter();
    readProgram(kProgram, options);
    EXPECT_EQ(log.waits, (std::vector<double>{0, 0}));
    EXPECT_FALSE(isUsed(Limit::wait_after_m400, log.from));
    LastLimits stated;
    options.motion = &stated;
    options.printer->set(Limit::wait_after_m400, 0.3, LimitOrigin::Kind::printer, "my.json:1");
    readProgram(kProgram, options);
    EXPECT_EQ(stated.waits, (std::vector<double>{0.3, 0}));
    EXPECT_TRUE(isUsed(Limit::wait_after_m400, stated.from));
}

TEST(MachineLimits, OfACommandHoldWhereTheFirmwareReadsIt) {
    constexpr const char* kProgram =
        "M83\nM201 X1 Z1\nM203 X1 Z1\nM205 X1\nM566 X1\nM204 P100\nM204 P700 T800\nSET_VELOCITY_LIMIT VELOCITY=50\n"
        "M204 S900\nG1 X1 E1\n";
    LastLimits log;
    ReadOptions options;
    options.motion = &log;
    options.printer = klipperPrinter();
    const Toolpath toolpath = readProgram(kProgram, options);
    EXPECT_EQ(toolpath.firmware, "klipper");
    EXPECT_EQ(toolpath.firmware_reason, "as printer.cfg says");
    EXPECT_EQ(log.last.speed[2], 300);
    EXPECT_EQ(log.last.path_speed, 50);
    EXPECT_EQ(log.last.printing, 900);
    EXPECT_EQ(log.last.travel, 900);
    EXPECT_EQ(log.from.rule, CornerRule::corner_velocity);
    EXPECT_EQ(log.from[Limit::printing].changes, 2U);
    EXPECT_EQ(log.from[Limit::printing].first_change, 7U);
    EXPECT_EQ(log.from[Limit::printing].value, 3000);
    const auto warned = [&toolpath](std::string_view part) {
        for (const Warning& warning : toolpath.warnings)
            if (warning.text.find(part) != std::string::npos) return warning.first_line;
        return 0U;
    };
    EXPECT_EQ(warned("M201: Klipper has no such command"), 2U);
    EXPECT_EQ(warned("M203: Klipper"), 3U);
    EXPECT_EQ(warned("M205: Klipper"), 4U);
    EXPECT_EQ(warned("M566: Klipper"), 5U);
    EXPECT_EQ(warned("M204 without S, or P and T together"), 6U);
    // The corner velocities and the like, which klipperPrinter() leaves out.
    EXPECT_EQ(warned("7 of them are assumed for the times"), 1U);

    // Marlin obeys all of them.
    options.printer->firmware = Firmware::marlin;
    options.printer->limits.rule = CornerRule::marlin_jerk;
    EXPECT_EQ(readProgram("M83\nM203 X7\nM92 X80\nG1 X1 E1\n", options).firmware, "marlin");
    EXPECT_EQ(log.last.speed[0], 7);
    EXPECT_EQ(log.last.steps_per_mm[0], 80);
    EXPECT_EQ(log.last.rule, CornerRule::marlin_jerk);
    options.firmware = Firmware::reprap;
    EXPECT_THROW(readProgram("G1 X1 E1\n", options), UsageError);
}

}  // namespace
}  // namespace stratum::gcode

#include "deposit/limits/limit_files.h"

#include "deposit/limits/printer_files.h"

namespace stratum::deposit {
namespace {

using gcode::CornerRule;
using gcode::Limit;
using gcode::LimitOrigin;

TEST(JsonLimits, HaveAKeyForEveryLimit) {
    const PrinterFiles files;
    const gcode::PrinterLimits printer = files.read(R"({"limits": {
        "firmware": "klipper",
        "max_velocity_mm_s": 1, "max_accel_mm_s2": 2, "minimum_cruise_ratio": 0.3,
        "square_corner_velocity_mm_s": 4, "max_z_velocity_mm_s": 5, "max_z_accel_mm_s2": 6,
        "max_extrude_only_velocity_mm_s": 7, "max_extrude_only_accel_mm_s2": 8,
        "instantaneous_corner_velocity_mm_s": 9, "arc_resolution_mm": 10, "jerk_mm_s": [11, 12, 13, 14],
        "steps_per_mm": [15, 16, 17, 18], "junction_deviation_mm": 0.19, "least_printing_speed_mm_s": 20,
        "least_travel_speed_mm_s": 21, "wait_after_m400_s": 0.3}})");
    const gcode::MachineLimits& limits = printer.limits;
    EXPECT_EQ(printer.firmware, gcode::Firmware::klipper);
    EXPECT_EQ(limits.rule, CornerRule::corner_velocity);
    EXPECT_EQ(limits.path_speed, 1);
    EXPECT_EQ(limits.printing, 2);
    EXPECT_EQ(limits.travel, 2);
    EXPECT_EQ(limits.cruise_ratio, 0.3);
    EXPECT_EQ(limits.corner_velocity, 4);
    EXPECT_EQ(limits.speed[2], 5);
    EXPECT_EQ(limits.acceleration[2], 6);
    EXPECT_EQ(limits.extrude_only_speed, 7);
    EXPECT_EQ(limits.retracting, 8);
    EXPECT_EQ(limits.extruder_corner_velocity, 9);
    EXPECT_EQ(limits.arc_resolution, 10);
    EXPECT_EQ(limits.jerk[3], 14);
    EXPECT_EQ(limits.steps_per_mm[0], 15);
    EXPECT_EQ(limits.junction_deviation, 0.19);
    EXPECT_EQ(limits.least_printing_speed, 20);
    EXPECT_EQ(limits.least_travel_speed, 21);
    EXPECT_EQ(limits.wait_after_m400, 0.3);
    EXPECT_EQ(placeOf(printer, Limit::corner_velocity), "printer:4");
    EXPECT_EQ(printer.origins[Limit::speed].kind, LimitOrigin::Kind::assumed);
}

TEST(JsonLimits, ChooseTheRuleOfTheFirmware) {
    const PrinterFiles files;
    const auto rule = [&files](const char* keys) {
        return files.read(std::string("{\"limits\": {") + keys + "}}").limits.rule;
    };
    EXPECT_EQ(rule(R"("printing_mm_s2": 900)"), CornerRule::automatic);
    EXPECT_EQ(rule(R"("junction_deviation_mm": 0.02)"), CornerRule::junction_deviation);
    EXPECT_EQ(rule(R"("firmware": "marlin", "jerk_mm_s": [8, 8, 0.4, 5])"), CornerRule::marlin_jerk);
    EXPECT_EQ(rule(R"("firmware": "reprap")"), CornerRule::reprap_jerk);
}

TEST(JsonLimits, MayBeAFirmwaresFileBesideIt) {
    const PrinterFiles files;
    files.write("my.cfg", "[printer]\nmax_velocity: 300\nmax_accel: 3000\n");
    EXPECT_EQ(files.read(R"({"beads": "settled", "limits": "my.cfg"})").limits.path_speed, 300);
    EXPECT_TRUE(says(files.refusal(R"({"limits": "yours.cfg"})"), "yours.cfg is no file"));
}

TEST(JsonLimits, AreRefusedWithTheirKey) {
    const PrinterFiles files;
    EXPECT_TRUE(says(files.refusal(R"({"limits": {"foo": 1}})"), "limits.foo: unknown key"));
    EXPECT_TRUE(
        says(files.refusal(R"({"limits": {"max_accel_mm_s2": 0}})"), "limits.max_accel_mm_s2: expected a number"));
    EXPECT_TRUE(says(files.refusal(R"({"limits": {"max_accel_mm_s2": 1e300}})"), "limits.max_accel_mm_s2"));
    EXPECT_TRUE(says(files.refusal(R"({"limits": {"max_accel_mm_s2": "fast"}})"), "limits.max_accel_mm_s2"));
    EXPECT_TRUE(says(files.refusal(R"({"limits": {"firmware": "klippy"}})"), "klipper, marlin or reprap"));
    EXPECT_TRUE(says(files.refusal(R"({"limits": {"max_z_velocity_mm_s": 1, "speed_mm_s": [1, 1, 1, 1]}})"),
                     "each limit once"));
}

}  // namespace
}  // namespace stratum::deposit

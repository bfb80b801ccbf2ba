#include "gcode/machine/motion_recorder.h"

#include "program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace stratum::gcode {
namespace {

class Log : public MotionSink {
public:
    void limits(const MachineLimits& limits) override { last = limits; }
    void move(const Move& move) override { moves.push_back(move); }
    void wait(double seconds) override { waits.push_back(seconds); }

    MachineLimits last;
    std::vector<Move> moves;
    std::vector<double> waits;
    Toolpath toolpath;
};

void record(std::string_view program, Log& log) {
    ReadOptions options;
    options.motion = &log;
    log.toolpath = readProgram(program, options);
}

TEST(MotionRecorder, TellsEverythingThatMoves) {
    Log log;
    record(
        "M83\nG0 X10 F6000\nG1 X20 E1 F1200\nG1 E-2 F2400\nG1 Z.4\nG1 E2\nG2 X30 I5 E1\nG2 X20 I-5\n"
        "M221 S50\nG1 Y5 E1\nG1 Y5 Z.4\n",
        log);
    ASSERT_EQ(log.moves.size(), 8U);
    EXPECT_EQ(log.moves[0].delta[0], 10);
    EXPECT_EQ(log.moves[0].speed, 100);
    EXPECT_EQ(log.moves[0].bead, Move::kNoBead);
    EXPECT_EQ(log.moves[1].bead, 0U);
    EXPECT_EQ(log.moves[1].delta[3], 1);
    EXPECT_EQ(log.moves[1].line, 3U);
    EXPECT_EQ(log.moves[2].delta[3], -2);
    EXPECT_EQ(log.moves[3].delta[2], 0.4);
    EXPECT_EQ(log.moves[5].bead, 1U);
    EXPECT_NE(log.moves[5].sweep, 0);
    EXPECT_EQ(log.moves[6].bead, Move::kNoBead);  // an arc without E
    EXPECT_NE(log.moves[6].sweep, 0);
    EXPECT_EQ(log.moves[7].delta[3], 0.5);
}

// Bambu's printers with two nozzles: filament is loaded anew only where the nozzle had another; what the printer does
// by itself is in comments, and in SYNC. As BambuStudio's and OrcaSlicer's GCodeProcessor::process_filament_change().
TEST(MotionRecorder, ChangesFilamentsOfSeveralExtruders) {
    Log log;
    record(
        "; filament_map = 2,1,1\n; machine_load_filament_time = 30\n; machine_unload_filament_time = 20\n"
        "; machine_tool_change_time = 5.6\nM83\nT0\nG1 X1 E1 F600\nT1\nG1 X2 E1\n;VG1 E4 F120\nSYNC T15\nT0\nT0\nG1 X3 "
        "E1\nT2\n",
        log);
    EXPECT_EQ(log.waits, (std::vector<double>{30, 35.6, 2, 15, 5.6, 55.6}));
    EXPECT_EQ(log.moves.size(), 3U);
    for (const Warning& warning : log.toolpath.warnings) EXPECT_EQ(warning.text.find("SYNC"), std::string::npos);
    // All filaments in one: each change unloads and loads.
    Log one;
    record(
        "; filament_map = 1,1\n; machine_switch_extruder_time = 5\n; machine_load_filament_time = 30\n; "
        "machine_unload_filament_time = 20\nM83\nT0\n"
        "G1 X1 E1 F600\nT1\nG1 X2 E1\n",
        one);
    EXPECT_EQ(one.waits, (std::vector<double>{50}));
}

TEST(MotionRecorder, TakesLimits) {
    Log log;
    record(
        "M83\nM201 X100 Y200 Z300 E400\nM203 X10 Y20 Z30 E40\nM204 P500 R600 T700\nM205 X1 Y2 Z3 E4\nM205 S5 T6\n"
        "G1 X1 E1\n",
        log);
    EXPECT_EQ(log.last.acceleration, (std::array<double, 4>{100, 200, 300, 400}));
    EXPECT_EQ(log.last.speed, (std::array<double, 4>{10, 20, 30, 40}));
    EXPECT_EQ(log.last.jerk, (std::array<double, 4>{1, 2, 3, 4}));
    EXPECT_EQ(log.last.printing, 500);
    EXPECT_EQ(log.last.retracting, 600);
    EXPECT_EQ(log.last.travel, 700);
    EXPECT_EQ(log.last.least_printing_speed, 5);
    EXPECT_EQ(log.last.least_travel_speed, 6);
    record("M83\nM566 X600 Y300\nM204 S800\nG1 X1 E1\n", log);
    EXPECT_EQ(log.last.jerk[0], 10);
    EXPECT_EQ(log.last.jerk[1], 5);
    EXPECT_EQ(log.last.printing, 800);
    EXPECT_EQ(log.last.travel, 800);
    // Marlin reads these in the unit of lengths (gcode/config/M200-M205.cpp, value_linear_units).
    record("G20\nM83\nM204 S40\nM205 X.5 S.25\nG1 X1 E.01\n", log);
    EXPECT_EQ(log.last.printing, 40 * 25.4);
    EXPECT_EQ(log.last.jerk[1], 0.5 * 25.4);
    EXPECT_EQ(log.last.least_printing_speed, 0.25 * 25.4);
    record("M83\nM205 J0.02\nG1 X1 E1\n", log);
    EXPECT_EQ(log.last.junction_deviation, 0.02);
    EXPECT_EQ(log.last.rule, CornerRule::junction_deviation);
    record("M83\nSET_VELOCITY_LIMIT VELOCITY=300 ACCEL=4000 ACCEL_TO_DECEL=1000 SQUARE_CORNER_VELOCITY=8\nG1 X1 E1\n",
           log);
    EXPECT_EQ(log.last.path_speed, 300);
    EXPECT_EQ(log.last.travel, 4000);
    EXPECT_EQ(log.last.cruise_ratio, 0.5);  // Klipper no longer reads ACCEL_TO_DECEL
    EXPECT_EQ(log.last.corner_velocity, 8);
    EXPECT_EQ(log.last.rule, CornerRule::corner_velocity);
}

TEST(MotionRecorder, RefusesLimitsThatNoMachineHas) {
    Log log;
    record(
        "M83\nM201 X0 Y-5 Z1000000000000\nM203 X0\nM204\nM204 P0 T-1\nM205 X-1\nM205 J-1\nG4 S-3\nG4 S1e9\n"
        "M566 X-60\nG1 X1 E1 F0\nSET_VELOCITY_LIMIT ACCEL=0\nM566 X600\nG1 X2 E1 F0.0001\n",
        log);
    const MachineLimits usual;
    EXPECT_EQ(log.last.acceleration[0], usual.acceleration[0]);
    EXPECT_EQ(log.last.acceleration[1], usual.acceleration[1]);
    EXPECT_EQ(log.last.acceleration[2], boundsOf(Limit::acceleration).most);
    EXPECT_EQ(log.last.speed, usual.speed);
    EXPECT_EQ(log.last.printing, usual.printing);
    EXPECT_EQ(log.last.travel, usual.travel);
    EXPECT_EQ(log.last.jerk, usual.jerk);
    EXPECT_EQ(log.last.junction_deviation, usual.junction_deviation);
    const auto lineOf = [&](std::string_view part) {
        for (const Warning& warning : log.toolpath.warnings)
            if (warning.text.find(part) != std::string::npos) return warning.first_line;
        return 0U;
    };
    EXPECT_EQ(lineOf("M201 X0"), 2U);
    EXPECT_EQ(lineOf("M201 Y-5"), 2U);
    EXPECT_EQ(lineOf("M201 Z1e+12 is more"), 2U);
    EXPECT_EQ(lineOf("M203 X0"), 3U);
    EXPECT_EQ(lineOf("M204 without an acceleration"), 4U);
    EXPECT_EQ(lineOf("M204 P0"), 5U);
    EXPECT_EQ(lineOf("M205 X-1"), 6U);
    EXPECT_EQ(lineOf("M205 J-1"), 7U);
    EXPECT_EQ(lineOf("G4 with a time below zero"), 8U);
    EXPECT_EQ(lineOf("M566 X-1"), 10U);
    EXPECT_EQ(lineOf("ACCEL=0"), 12U);
    EXPECT_EQ(lineOf("M566: Klipper has no such command"), 13U);
    for (const Move& move : log.moves) EXPECT_GE(move.speed, 0.01);
}

TEST(MotionRecorder, LimitsOfOthersAreLeftAlone) {
    Log log;
    record("M83\nM201 X900\nM201.1 X100\nM201 T1 E1\nM205 X8 Y4\nM205 X-1\nG1 X10 E1 F600\n", log);
    EXPECT_EQ(log.last.acceleration[0], 900);
    EXPECT_GT(log.last.acceleration[3], 1);
    EXPECT_EQ(log.last.jerk[0], 8);
    EXPECT_EQ(log.last.jerk[1], 4);
    Log reprap;
    ReadOptions options;
    options.motion = &reprap;
    options.firmware = Firmware::reprap;
    (void)readProgram("M83\nM203 X600\nG1 X10 E1 F600\n", options);
    EXPECT_NEAR(reprap.last.speed[0], 10, 1e-9);
}

TEST(MotionRecorder, FirmwareRetractsByWhatTheFileSays) {
    Log log;
    record("M83\nG1 X1 E1 F600\nG10\nG11\n", log);
    EXPECT_EQ(log.moves.size(), 1U);  // a length that nobody told
    log.moves.clear();
    record("M83\nM207 S2 F1800\nG1 X1 E1 F600\nG10\nG10\nG1 X5\nG11\nG11\nG10 P1 X3\n", log);
    ASSERT_EQ(log.moves.size(), 4U);
    EXPECT_EQ(log.moves[1].delta[3], -2);
    EXPECT_EQ(log.moves[1].speed, 30);
    EXPECT_EQ(log.moves[3].delta[3], 2);
}

constexpr std::string_view kKlipper = "\n; gcode_flavor = klipper\n";

TEST(MotionRecorder, KlipperWaitsForMillisecondsOnly) {
    Log log;
    record("M83\nG1 X1 E1 F600\nG4 S2\nG1 X2 E1\nG4 P1500\nG1 X3 E1" + std::string(kKlipper), log);
    EXPECT_EQ(log.waits, (std::vector<double>{0, 1.5}));
}

TEST(MotionRecorder, KlipperRetractsBySetRetraction) {
    Log log;
    record(
        "M83\nM207 S5\nSET_RETRACTION RETRACT_LENGTH=2 RETRACT_SPEED=30 UNRETRACT_EXTRA_LENGTH=0.5 "
        "UNRETRACT_SPEED=15\nG1 X1 E1 F600\nG10\nG10\nG1 X5\nG11" +
            std::string(kKlipper),
        log);
    ASSERT_EQ(log.moves.size(), 4U);
    EXPECT_EQ(log.moves[1].delta[3], -2);
    EXPECT_EQ(log.moves[1].speed, 30);
    EXPECT_EQ(log.moves[3].delta[3], 2.5);
    EXPECT_EQ(log.moves[3].speed, 15);
}

TEST(MotionRecorder, KlippersCommandsMoveAtASpeedOfTheirOwn) {
    Log log;
    record(
        "M83\nG1 X1 E1 F600\nSAVE_GCODE_STATE NAME=a\nG1 X20 F3000\nRESTORE_GCODE_STATE NAME=a MOVE=1 "
        "MOVE_SPEED=77\nSAVE_GCODE_STATE NAME=b\nG1 X30\nRESTORE_GCODE_STATE NAME=b MOVE=1\n"
        "SET_GCODE_OFFSET Z=1 MOVE=1 MOVE_SPEED=5" +
            std::string(kKlipper),
        log);
    ASSERT_EQ(log.moves.size(), 6U);
    EXPECT_EQ(log.moves[2].delta[0], -19);
    EXPECT_EQ(log.moves[2].speed, 77);
    EXPECT_EQ(log.moves[4].speed, 10);  // the saved one
    EXPECT_EQ(log.moves[5].delta[2], 1);
    EXPECT_EQ(log.moves[5].speed, 5);
}

TEST(MotionRecorder, KlipperRefusesM204WithOneOfPAndT) {
    Log log;
    record("M83\nM204 P500\nM204 T700\nG1 X1 E1 F600" + std::string(kKlipper), log);
    EXPECT_EQ(log.last.printing, 3000);
    record("M83\nM204 P500 T700\nG1 X1 E1 F600" + std::string(kKlipper), log);
    EXPECT_EQ(log.last.printing, 500);
    EXPECT_EQ(log.last.travel, 500);
    record("M83\nM204 S90000\nG1 X1 E1 F600\n; machine_max_acceleration_extruding = 1000" + std::string(kKlipper), log);
    EXPECT_EQ(log.last.printing, 90000);
}

TEST(MotionRecorder, KlipperStopsToSwitchPressureAdvanceOnAndOff) {
    Log log;
    record(
        "M83\nG1 X1 E1 F600\nSET_PRESSURE_ADVANCE ADVANCE=0.04\nG1 X2 E1\nSET_PRESSURE_ADVANCE ADVANCE=0.05\n"
        "G1 X3 E1\nSET_PRESSURE_ADVANCE ADVANCE=0" +
            std::string(kKlipper),
        log);
    EXPECT_EQ(log.waits.size(), 2U);
}

// Linear Advance 1.0 of a Prusa MK3: no time depends on it.
TEST(MotionRecorder, OlderFactorsOfLinearAdvanceAreNoMatter) {
    Log log;
    record("M900 K30\nM83\nG1 Z.2\nG1 X10 E1\n", log);
    EXPECT_EQ(warningCount(log.toolpath, "pressure advance"), 0U);
    EXPECT_EQ(log.last.pressure_advance, 0);
}

TEST(MotionRecorder, TellsTheTimesBehindLayers) {
    class Clock : public Log {
    public:
        void elapsed(double seconds) override { marks.push_back(seconds); }
        std::vector<double> marks;
    };
    Clock log;
    record("M83\nG1 Z.2\nG1 X10 E1\n;TIME_ELAPSED:12.5\nG1 X0 E1\n;TIME_ELAPSED:nan\n;TIME_ELAPSED:31\n", log);
    EXPECT_EQ(log.marks, (std::vector<double>{12.5, 31}));
}

TEST(MotionRecorder, VolumesBecomeFilament) {
    Log log;
    record("M83\nM200 D1.75\nG1 X10 E2.4052819 F600\n", log);
    EXPECT_NEAR(log.moves.back().delta[3], 1, 1e-7);
}

TEST(MotionRecorder, ChangesOfToolTakeWhatTheSettingsSay) {
    Log log;
    // Nothing is loaded before the first change, as PrusaSlicer's GCodeProcessor has it.
    const std::string program = "M83\nT0\nG1 X1 E1 F600\nT1\nG1 X2 E1\nT0\nG1 X3 E1\n";
    record(program + "; filament_load_time = 10,20\n; filament_unload_time = 3,4\n", log);
    EXPECT_EQ(log.waits, (std::vector<double>{20, 14}));
    Log heads;
    record(program +
               "; filament_load_time = 10,20\n; filament_unload_time = 3,4\n"
               "; printer_notes = PRINTER_VENDOR_PRUSA3D\\nPRINTER_MODEL_XLIS\n",
           heads);
    EXPECT_EQ(heads.waits, (std::vector<double>{4.5, 4.5}));
}

TEST(MachineSettings, AreReadFromTrailers) {
    const MachineSettings prusa = readMachineSettings(
        "; gcode_flavor = marlin2\n; machine_max_acceleration_x = 2500,1200\n; machine_max_feedrate_z = 12\n"
        "; machine_max_jerk_e = 3\n; machine_max_acceleration_extruding = 2000\n; machine_max_acceleration_travel = "
        "2600\n",
        CornerRule::automatic);
    EXPECT_EQ(prusa.limits.acceleration[0], 2500);
    EXPECT_EQ(prusa.limits.speed[2], 12);
    EXPECT_EQ(prusa.limits.jerk[3], 3);
    EXPECT_EQ(prusa.limits.printing, 2000);
    EXPECT_EQ(prusa.limits.travel, 2600);
    EXPECT_EQ(prusa.most_printing, 2000);
    EXPECT_EQ(prusa.limits.rule, CornerRule::slicer_jerk);
    EXPECT_EQ(readMachineSettings("; gcode_flavor = marlin\n; machine_max_acceleration_extruding = 900\n",
                                  CornerRule::automatic)
                  .limits.travel,
              900);
    EXPECT_EQ(readMachineSettings("; machine_max_speed_x = 350,160\n", CornerRule::automatic).limits.speed[0], 350);
    EXPECT_EQ(readMachineSettings("; machine_max_junction_deviation = 0.02\n", CornerRule::automatic).limits.rule,
              CornerRule::junction_deviation);
    EXPECT_EQ(readMachineSettings("; gcode_flavor = klipper\n", CornerRule::automatic).limits.rule,
              CornerRule::corner_velocity);
    EXPECT_EQ(readMachineSettings("; gcode_flavor = klipper\n", CornerRule::jerk).limits.rule, CornerRule::jerk);
}

TEST(MachineSettings, NonsenseIsNoLimit) {
    const MachineLimits usual;
    const MachineSettings read = readMachineSettings(
        "; machine_max_acceleration_x = 0\n; machine_max_feedrate_y = -3\n; machine_max_jerk_z = nan\n"
        "; machine_max_acceleration_extruding = 99999999999\n; filament_load_time = -1\n",
        CornerRule::automatic);
    EXPECT_EQ(read.limits.acceleration, usual.acceleration);
    EXPECT_EQ(read.limits.speed, usual.speed);
    EXPECT_EQ(read.limits.jerk, usual.jerk);
    EXPECT_EQ(read.limits.printing, usual.printing);
    EXPECT_TRUE(read.load.empty());
}

TEST(MotionRecorder, SaysWhereMovesBeginAndWhatStopsThem) {
    class Stops : public Log {
    public:
        void stop(Stop kind, std::uint32_t line) override { stops.emplace_back(kind, line); }
        std::vector<std::pair<Stop, std::uint32_t>> stops;
    } log;
    record("M83\nG1 X10 Y5 Z.2\nG1 X20 E1\nT1\nT1\nM0\nM400\nM400 U1\nM600\nPAUSE\nM601\nG92 X0\nG1 X5 E1\n", log);
    ASSERT_EQ(log.moves.size(), 3U);
    EXPECT_EQ(log.moves[1].start, (std::array<double, 3>{10, 5, 0.2}));
    EXPECT_EQ(log.moves[2].start, (std::array<double, 3>{20, 5, 0.2}));
    const std::vector<std::pair<Stop, std::uint32_t>> wanted{{Stop::tool_change, 4}, {Stop::pause, 6},
                                                             {Stop::pause, 8},       {Stop::filament_change, 9},
                                                             {Stop::pause, 10},      {Stop::pause, 11}};
    EXPECT_EQ(log.stops, wanted);
}

TEST(Machine, RemembersTemperaturesAndTheFan) {
    const Toolpath toolpath = readProgram(
        "M83\nM104 S215\nM109 R200 T1\nM106 S127.5\nG1 X10 E1\nM106 P2 S255\nM106\nG10 P0 S190\n"
        "SET_HEATER_TEMPERATURE HEATER=extruder1 TARGET=230\nSET_HEATER_TEMPERATURE HEATER=heater_bed TARGET=60\n"
        "G1 X20 E1\nM107\nM104 S-5\n");
    ASSERT_EQ(toolpath.temperatures.size(), 4U);
    EXPECT_EQ(toolpath.temperatures[1].tool, 1);
    EXPECT_EQ(toolpath.temperatures[1].value, 200.0F);
    EXPECT_EQ(toolpath.temperatures[2].value, 190.0F);
    EXPECT_EQ(toolpath.temperatures[2].line, 8U);
    EXPECT_EQ(toolpath.temperatures[3].value, 230.0F);
    ASSERT_EQ(toolpath.fans.size(), 3U);
    EXPECT_NEAR(toolpath.fans[0].value, 50.0F, 1e-4F);
    EXPECT_EQ(toolpath.fans[1].value, 100.0F);
    EXPECT_EQ(toolpath.fans[1].line, 7U);
    EXPECT_EQ(toolpath.fans[2].value, 0.0F);
}

TEST(Machine, RemembersAccelerationsAndPressureAdvance) {
    const Toolpath toolpath = readProgram(
        "M83\nM204 P1000 T3000\nM900 K0.05\nG1 X10 E1\nM204 T2000\nM204 S500\nM204 P500\nM900 K0.05\nM572 D1 S.03\n"
        "M900 K75\nG1 X20 E1\nSET_VELOCITY_LIMIT ACCEL=4000 VELOCITY=200\nSET_VELOCITY_LIMIT VELOCITY=300\n"
        "SET_PRESSURE_ADVANCE EXTRUDER=extruder1 ADVANCE=0.02\nSET_PRESSURE_ADVANCE SMOOTH_TIME=0.01\n"
        "G20\nM204 P100\nG1 X2 E.1\nM204 S-1\n");
    const auto valuesOf = [](const std::vector<SetValue>& set) {
        std::vector<std::tuple<std::uint32_t, int, float>> values;
        for (const SetValue& one : set) values.emplace_back(one.line, one.tool, one.value);
        return values;
    };
    using Values = std::vector<std::tuple<std::uint32_t, int, float>>;
    EXPECT_EQ(valuesOf(toolpath.accelerations),
              (Values{{2, 0, 1000.0F}, {6, 0, 500.0F}, {12, 0, 4000.0F}, {17, 0, 2540.0F}}));
    EXPECT_EQ(valuesOf(toolpath.pressure_advances), (Values{{3, 0, 0.05F}, {9, 1, 0.03F}, {14, 1, 0.02F}}));
}

}  // namespace
}  // namespace stratum::gcode

#include "motion/print_times.h"

#include "corpus.h"
#include "gcode/container/container.h"
#include "motions.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

namespace stratum::motion {
namespace {

struct Timed {
    gcode::Toolpath toolpath;
    PrintTimes times;
};

Timed timed(std::string_view program) {
    Timed result;
    result.toolpath = readTimedToolpath(program, "test.gcode", {}, result.times);
    return result;
}

Timed timedFile(const std::filesystem::path& path, gcode::CornerRule rule = gcode::CornerRule::automatic) {
    const gcode::InputBytes file(path.string());
    gcode::ReadOptions options;
    options.corner_rule = rule;
    Timed result;
    result.toolpath = readTimedToolpath(file.bytes(), file.name(), options, result.times);
    return result;
}

// The second carriage lays its copy while the first lays the bead.
TEST(PrintTimes, CopiesAreLaidWithTheirBeads) {
    const Timed print = timed("M83\nM605 S2 X100\nG1 Z.2 F600\nG1 X20 E1\nG4 S600\nG1 Y10 E1\n");
    ASSERT_EQ(print.toolpath.timing.size(), 4U);
    const auto& timing = print.toolpath.timing;
    for (const std::size_t copy : {1U, 3U}) {
        EXPECT_NEAR(timing[copy].start, timing[copy - 1].start + static_cast<double>(timing[copy - 1].seconds), 1e-6);
        EXPECT_EQ(timing[copy].peak, timing[copy - 1].peak);
        EXPECT_EQ(timing[copy].seconds, 0);
    }
}

struct Stated {
    const char* file;
    double seconds;
    double within;  // a share
    gcode::CornerRule rule = gcode::CornerRule::automatic;
};

class StatedTime : public testing::TestWithParam<Stated> {};
INSTANTIATE_TEST_SUITE_P(
    Corpus, StatedTime,
    testing::Values(Stated{"gcode/Printrun-testgeometry.gcode", 4441, 0.002},
                    Stated{"gcode/libbgcode-mini_cube_a.gcode", 1926, 0.002},
                    Stated{"gcode/libbgcode-mini_cube_b.bgcode", 1926, 0.002},
                    Stated{"gcode/preprocess_cancellation-prusaslicer.gcode", 536, 0.006},
                    Stated{"gcode/preprocess_cancellation-m486.gcode", 536, 0.006},
                    // For Klipper, but the slicer states the time by its own rule.
                    Stated{"gcode/preprocess_cancellation-superslicer.gcode", 439, 0.006,
                           gcode::CornerRule::slicer_jerk},
                    Stated{"gcode/vase_ps25.gcode", 2927, 0.003},
                    Stated{"gcode/volumetric_fwretract.gcode", 1184, 0.005},
                    Stated{"gcode/spot_1000cc_0.1mm_grid.gcode.gz", 73427, 0.002},
                    Stated{"gcode/preprocess_cancellation-cura.gcode", 451, 0.02},
                    Stated{"gcode/bgautrea-ender3_cura.gcode.gz", 3328, 0.01},
                    Stated{"gcode/RRFInstall-cube_huelle.gcode.gz", 812, 0.005},
                    Stated{"gcode/K1_Series_Klipper-K1C_3DBenchy.gcode.gz", 890, 0.1, gcode::CornerRule::slicer_jerk},
                    Stated{"cases/22_cura_creality_acceleration.gcode", 36.2, 0.02},
                    Stated{"cases/28_square_corner_velocity.gcode", 11.9, 0.02, gcode::CornerRule::slicer_jerk},
                    Stated{"gcode/filaswitch-mc_testmodel1_Cura.gcode", 2656, 0.05}),
    [](const auto& chosen) { return fmt::format("n{}", chosen.index); });

TEST_P(StatedTime, IsWhatThePlanTakes) {
    STRATUM_NEEDS_CORPUS(path, GetParam().file);
    const Timed print = timedFile(path, GetParam().rule);
    EXPECT_NEAR(print.times.total, GetParam().seconds, GetParam().within * GetParam().seconds) << GetParam().file;
}

class OwnPrints : public testing::TestWithParam<Stated> {};
INSTANTIATE_TEST_SUITE_P(Data, OwnPrints,
                         testing::Values(Stated{"bridges", 3444, 0.003}, Stated{"gear", 1820, 0.003},
                                         Stated{"hull", 2309, 0.003}, Stated{"knot", 1847, 0.003},
                                         Stated{"tile", 303, 0.003}, Stated{"two_tone", 1105, 0.003},
                                         Stated{"two_tone_mmu", 1433, 0.003}, Stated{"vase", 1054, 0.003}),
                         [](const auto& chosen) { return std::string(chosen.param.file); });

TEST_P(OwnPrints, TakeWhatPrusaSlicerSays) {
    const Timed print = timedFile(test::dataDir() / "gcode" / (std::string(GetParam().file) + ".gcode"));
    EXPECT_NEAR(print.times.total, GetParam().seconds, GetParam().within * GetParam().seconds + 0.5);
    EXPECT_EQ(print.times.rule, "slicer-jerk");
}

// check(text, seconds) of each line, with the time that is planned for it.
template <typename Check>
void atEachLine(std::string_view program, const PlanList& plan, const Check& check) {
    std::size_t piece = 0;
    for (std::uint32_t line = 1; !program.empty(); ++line) {
        while (piece < plan.pieces.size() && plan.pieces[piece].segment.line < line) ++piece;
        const auto end = std::min(program.find('\n'), program.size());
        check(std::string(program.substr(0, end)),
              piece < plan.pieces.size() ? plan.pieces[piece].start : plan.seconds);
        program.remove_prefix(std::min(end + 1, program.size()));
    }
}

// What M73 P says of the time at its line: minutes that are left, cut or rounded.
TEST(PrintTimes, EveryM73IsMet) {
    for (const char* name : {"gcode/Printrun-testgeometry.gcode", "gcode/libbgcode-mini_cube_a.gcode"}) {
        STRATUM_NEEDS_CORPUS(path, name);
        const gcode::InputBytes file(path.string());
        const PlanList plan = planOf(file.bytes());
        int checked = 0;
        atEachLine(file.bytes(), plan, [&](const std::string& text, double now) {
            int percent = 0;
            int minutes = 0;
            if (std::sscanf(text.c_str(), "M73 P%d R%d", &percent, &minutes) != 2) return;
            EXPECT_NEAR(plan.seconds - now, 60.0 * minutes, 60 + 0.01 * plan.seconds) << name << ": " << text;
            EXPECT_NEAR(100 * now / plan.seconds, percent, 1.6) << name << ": " << text;
            ++checked;
        });
        EXPECT_GT(checked, 100) << name;
    }
}

TEST(PrintTimes, CurasLayersAreMet) {
    STRATUM_NEEDS_CORPUS(path, "gcode/preprocess_cancellation-cura.gcode");
    const gcode::InputBytes file(path.string());
    const PlanList plan = planOf(file.bytes());
    int checked = 0;
    atEachLine(file.bytes(), plan, [&checked](const std::string& text, double now) {
        double elapsed = 0;
        if (std::sscanf(text.c_str(), ";TIME_ELAPSED:%lf", &elapsed) != 1) return;
        EXPECT_NEAR(now, elapsed, 5 + 0.05 * elapsed) << text;
        ++checked;
    });
    EXPECT_EQ(checked, 25);
}

TEST(PrintTimes, SumsAddUp) {
    const Timed print = timedFile(test::dataDir() / "gcode" / "two_tone.gcode");
    const PrintTimes& t = print.times;
    EXPECT_NEAR(std::accumulate(t.layers.begin(), t.layers.end(), 0.0), t.total, 1e-6 * t.total);
    const double beads = std::accumulate(t.features.begin(), t.features.end(), 0.0);
    EXPECT_NEAR(beads + t.travel + t.retraction + t.waiting, t.total, 1e-5 * t.total);
    ASSERT_EQ(print.toolpath.timing.size(), print.toolpath.beads.size());
    double before = 0;
    for (const gcode::BeadTiming& timing : print.toolpath.timing) {
        EXPECT_GE(timing.start, before - 1e-4);
        EXPECT_GT(timing.seconds, 0);
        before = timing.start + static_cast<double>(timing.seconds);
    }
    EXPECT_LE(before, t.total + 1e-3);
}

TEST(PrintTimes, PlanningLeavesTheToolpathAlone) {
    const std::filesystem::path path = test::dataDir() / "gcode" / "two_tone_mmu.gcode";
    const gcode::InputBytes file(path.string());
    const gcode::Toolpath plain = gcode::readToolpath(file.bytes(), file.name());
    const Timed print = timedFile(path);
    EXPECT_TRUE(plain.timing.empty());
    ASSERT_EQ(plain.beads.size(), print.toolpath.beads.size());
    EXPECT_EQ(std::memcmp(plain.beads.data(), print.toolpath.beads.data(), plain.beads.size() * sizeof(gcode::Bead)),
              0);
    EXPECT_TRUE(plain.runs == print.toolpath.runs);
}

TEST(PrintTimes, BeadsOfArcsAndCurvesHaveTheirTime) {
    // A half circle of 10 mm at 10 mm/s, much faster than the corners between its pieces need.
    const Timed print = timed("M83\nG1 X1 E.1 F600\nG3 X1 Y20 J10 E2\nG5 X21 Y20 I5 J5 P-5 Q5 E2\n");
    ASSERT_EQ(print.toolpath.timing.size(), print.toolpath.beads.size());
    EXPECT_NEAR(static_cast<double>(print.toolpath.timing[1].seconds), std::numbers::pi, 0.02);
    for (const gcode::BeadTiming& timing : print.toolpath.timing) EXPECT_GT(timing.seconds, 0);
}

TEST(PrintTimes, RulesHaveNames) {
    using gcode::CornerRule;
    EXPECT_EQ(ruleName(CornerRule::automatic), "auto");
    EXPECT_EQ(ruleName(CornerRule::jerk), "jerk");
    EXPECT_EQ(ruleName(CornerRule::slicer_jerk), "slicer-jerk");
    EXPECT_EQ(ruleName(CornerRule::plan_jerk), "plan-jerk");
    EXPECT_EQ(ruleName(CornerRule::junction_deviation), "junction-deviation");
    EXPECT_EQ(ruleName(CornerRule::corner_velocity), "corner-velocity");
}

// CuraEngine doesn't read the user's start and end programs.
TEST(PrintTimes, CurasTimeIsWithoutStartAndEndProgram) {
    const Timed print = timed(
        ";FLAVOR:Marlin\n;TIME:10\n;Generated with Cura_SteamEngine 5.0\nM83\nG28\nG1 Z.3 F600\nG1 X100 E9\nG1 X0 E9\n"
        ";LAYER_COUNT:1\n;LAYER:0\nG1 X100 E4\n;TIME_ELAPSED:10\nG1 Y200\nM84\n;End of Gcode\n");
    const stratum::motion::StatedTime time = statedTime(print.times, print.toolpath.stated);
    EXPECT_EQ(time.stated, 10);
    EXPECT_NEAR(time.planned, 10, 0.3);
    EXPECT_NEAR(print.times.total, 50, 1);
    EXPECT_NEAR(print.times.after_model, 20, 0.3);
}

// BambuStudio states the model's time apart from that of the start program.
TEST(PrintTimes, TheStatedTimeOfTheModelIsBesideThePlannedOne) {
    const Timed print = timed(
        "; model printing time: 10s; total estimated time: 1m 10s\nM83\nG1 X200 F600\nG1 X0\n; CHANGE_LAYER\n"
        "; LAYER_HEIGHT: 0.2\nG1 Z.2\nG1 X100 E4 F600\n");
    const stratum::motion::StatedTime time = statedTime(print.times, print.toolpath.stated);
    EXPECT_EQ(time.stated, 10);
    EXPECT_NEAR(time.planned, 10, 0.3);
    EXPECT_NEAR(print.times.total, 50, 1);
    gcode::StatedFacts whole;
    whole.seconds = 70;
    EXPECT_EQ(statedTime(print.times, whole).stated, 70);
    EXPECT_EQ(statedTime(print.times, whole).planned, print.times.total);
}

TEST(PrintTimes, OfTheCaseOfAModelsTime) {
    STRATUM_NEEDS_CORPUS(path, "cases/25_bambu_model_time.gcode");
    const Timed print = timedFile(path);
    EXPECT_NEAR(statedTime(print.times, print.toolpath.stated).planned, 10, 0.5);
}

// OrcaSlicer's estimate takes the square corner velocity for the jerk in the plane where the file states jerk.
TEST(PrintTimes, ACornerVelocityBesideStatedJerk) {
    std::string moves = "SET_VELOCITY_LIMIT ACCEL=5000 SQUARE_CORNER_VELOCITY=5\nM83\nG1 Z.2 F6000\n";
    for (int i = 0; i < 50; ++i) moves += "G1 X10 E.2\nG1 X0 E.2\n";
    const std::string jerk = "; machine_max_jerk_x = 500\n; machine_max_jerk_y = 500\n";
    EXPECT_GT(timed(moves + jerk).times.total,
              1.1 * timed("G4 P1\n" + moves.substr(moves.find("M83")) + jerk).times.total);
}

// A program of PrusaSlicer's kind, with an estimate of the time and a flavour.
std::string programFor(const std::string& flavor) {
    std::string moves = "; estimated printing time (normal mode) = 15s\nM83\nG1 Z.2 F6000\n";
    for (int i = 0; i < 100; ++i) moves += "G1 X10 E.2\nG1 X0 E.2\n";
    return moves + "; machine_max_jerk_x = 10\n; machine_max_jerk_y = 10\n; gcode_flavor = " + flavor + "\n";
}

std::optional<PrintTimes> estimateOf(const std::string& program, const gcode::ReadOptions& options = {}) {
    PrintTimes times;
    const gcode::Toolpath toolpath = readTimedToolpath(program, "test.gcode", options, times);
    return estimatedTimes(program, "test.gcode", options, times, toolpath);
}

// Klipper plans by its own rule, but slicers estimate the time as for any printer.
TEST(PrintTimes, TheEstimateForKlipperIsByTheSlicersRule) {
    const std::optional<PrintTimes> estimate = estimateOf(programFor("klipper"));
    ASSERT_TRUE(estimate);
    EXPECT_EQ(estimate->rule, "slicer-jerk");
    EXPECT_NEAR(estimate->total, timed(programFor("marlin")).times.total, 1e-9);
    EXPECT_FALSE(estimateOf(programFor("marlin")));
    gcode::ReadOptions options;
    options.corner_rule = gcode::CornerRule::corner_velocity;
    EXPECT_FALSE(estimateOf(programFor("klipper"), options));
}

// Moves of 100 and 20 mm at 10 mm/s, and one of 300 mm at 100 mm/s, however slowly the machine starts.
TEST(PrintTimes, ProgrammedSpeedsAreReachedAtOnce) {
    const std::string moves = "M204 S100\nM83\nG1 Z.2 F600\nG1 X100 E5\nG1 Y20 E1\nG0 X400 F6000\nG4 S2\n";
    gcode::ReadOptions options;
    options.corner_rule = gcode::CornerRule::programmed;
    PrintTimes times;
    readTimedToolpath(moves, "test.gcode", options, times);
    EXPECT_NEAR(times.total, 0.02 + 10 + 2 + 3 + 2, 1e-9);
    const std::string stated = ";   Build time: 0 hours 1 minutes\n";
    const auto estimate = estimateOf("; G-Code generated by Simplify3D(R) Version 4.1.2\n" + moves + stated);
    ASSERT_TRUE(estimate);
    EXPECT_EQ(estimate->rule, "programmed");
    EXPECT_NEAR(estimate->total, 17.02, 1e-9);
    const auto kiri = estimateOf("; Generated by Kiri:Moto 3.0\n" + moves + "; --- print time: 26s ---\n");
    ASSERT_TRUE(kiri);
    EXPECT_EQ(kiri->rule, "programmed times 1.5");
    EXPECT_NEAR(kiri->total, 1.5 * 17.02, 1e-9);
    EXPECT_NEAR(kiri->waiting, 3, 1e-9);
}

class Estimate : public testing::TestWithParam<Stated> {};
INSTANTIATE_TEST_SUITE_P(Corpus, Estimate,
                         testing::Values(Stated{"gcode/preprocess_cancellation-superslicer.gcode", 439, 0.006},
                                         Stated{"gcode/slicer-meta-orca_flashforge.gcode.3mf", 433, 0.02},
                                         Stated{"gcode/slicer-meta-orca_twocolors.gcode.3mf", 2803, 0.001},
                                         Stated{"gcode/slicer-meta-flashstudio_2color.gcode.3mf", 1698, 0.03},
                                         Stated{"gcode/orca2flashforge-test.gcode.gz", 2228, 0.002},
                                         Stated{"gcode/preprocess_cancellation-kirimoto.gcode", 806, 0.03},
                                         Stated{"gcode/filaswitch-mc_testmodel1_S3D.gcode", 2580, 0.12}));

TEST_P(Estimate, IsWhatTheFileStates) {
    STRATUM_NEEDS_CORPUS(path, GetParam().file);
    const gcode::InputBytes file(path.string());
    PrintTimes times;
    const gcode::Toolpath toolpath = readTimedToolpath(file.bytes(), file.name(), {}, times);
    EXPECT_TRUE(times.rule == "corner-velocity" || times.rule == "jerk") << times.rule;
    const auto estimate = estimatedTimes(file.bytes(), file.name(), {}, times, toolpath);
    ASSERT_TRUE(estimate);
    const double planned = statedTime(*estimate, toolpath.stated).planned;
    EXPECT_NEAR(planned, GetParam().seconds, GetParam().within * GetParam().seconds);
}

// PrusaSlicer and its kin estimate homing as a move to 0 at the speed of the move before.
TEST(PrintTimes, HomingIsAMoveInTheSlicersEstimate) {
    const std::string moves = "M83\nG1 Z.2 F600\nG1 X100 E9\n";
    const std::string jerk = "; machine_max_jerk_x = 10\n; machine_max_jerk_y = 10\n";
    const double without = timed(moves + jerk).times.total;
    EXPECT_NEAR(timed(moves + "G28 X\n" + jerk).times.total, without + 10, 0.1);
    EXPECT_NEAR(timed(moves + "G28 Y\n" + jerk).times.total, without, 1e-6);
    EXPECT_NEAR(timed(moves + "G1 Y100\nG28\n" + jerk).times.total, without + 10 + 10 * std::sqrt(2), 0.2);
    EXPECT_NEAR(timed(moves + "G28 X\n").times.total, timed(moves).times.total, 1e-6);
}

}  // namespace
}  // namespace stratum::motion

#include "motion/travels.h"

#include "motion/print_times.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string_view>
#include <vector>

namespace stratum::motion {
namespace {

constexpr std::string_view kProgram =
    "M83\n"
    "G1 X10 Y10 Z0.2 F6000\n"
    "G1 X20 E1 F1200\n"
    "G1 E-1 F2400\n"
    "G2 X30 Y10 I5 J0 F6000\n"
    "G1 E1 F2400\n"
    "G1 X40 E1 F1200\n"
    "G1 X35 E-0.5 F6000\n"
    "G1 X30 Y20 Z0.6\n"
    "G1 X20 E1 F1200\n";

TEST(Travels, AreTheMovesThatLayNothing) {
    std::vector<Travel> travels;
    TravelRecorder recorder(travels, nullptr);
    gcode::ReadOptions options;
    options.motion = &recorder;
    ASSERT_EQ(gcode::readToolpath(kProgram, "test.gcode", options).beads.size(), 3U);
    ASSERT_EQ(travels.size(), 4U);
    const std::uint32_t lines[] = {2, 5, 8, 9};
    const std::uint32_t beads[] = {0, 1, 2, 2};
    for (std::size_t n = 0; n < 4; ++n) {
        EXPECT_EQ(travels[n].line, lines[n]);
        EXPECT_EQ(travels[n].bead, beads[n]);
        EXPECT_EQ(travels[n].speed, 100.0F);
        EXPECT_EQ(travels[n].seconds, 0.0F);
    }
    EXPECT_EQ(travels[1].center_x, 25);
    EXPECT_EQ(travels[1].center_y, 10);
    EXPECT_NEAR(static_cast<double>(travels[1].sweep), -std::numbers::pi, 1e-6);
    EXPECT_EQ(travels[2].filament, -0.5F);
    EXPECT_EQ(travels[3].x0, 35);
    EXPECT_EQ(travels[3].y1, 20);
    EXPECT_EQ(travels[3].z1, 0.6);
}

// As a program that is read without its travels has them: limits that are fitted need the times behind the layers.
TEST(Travels, ChangeNoTimes) {
    struct Listener final : gcode::MotionSink {
        std::vector<double> seconds;
        void limits(const gcode::MachineLimits& /*limits*/) override {}
        void move(const gcode::Move& /*move*/) override {}
        void wait(double /*seconds*/) override {}
        void elapsed(double at) override { seconds.push_back(at); }
    };
    Listener listener;
    std::vector<Travel> travels;
    TravelRecorder recorder(travels, &listener);
    gcode::ReadOptions options;
    options.motion = &recorder;
    gcode::readToolpath(
        ";FLAVOR:Marlin\n;Generated with Cura_SteamEngine 5.0\nM83\nG1 X10 Z0.2 F6000\nG1 X20 E1 F1200\n"
        ";TIME_ELAPSED:12.5\nG1 X30 E1\n",
        "test.gcode", options);
    EXPECT_EQ(listener.seconds, std::vector<double>{12.5});
}

TEST(Travels, HaveTheirTimesInThePlan) {
    std::vector<Travel> travels;
    PrintTimes times;
    const gcode::Toolpath toolpath = readTimedToolpath(kProgram, "test.gcode", {}, times, nullptr, &travels);
    ASSERT_EQ(travels.size(), 4U);
    double sum = 0;
    for (const Travel& travel : travels) {
        sum += static_cast<double>(travel.seconds);
        // Between the beads that it is between.
        if (travel.bead > 0) {
            EXPECT_GE(travel.start, toolpath.timing[travel.bead - 1].start);
        }
        EXPECT_LE(travel.start, toolpath.timing[travel.bead].start);
    }
    EXPECT_NEAR(sum, times.travel, 1e-4);
    EXPECT_GT(travels[1].seconds, 0.15F);  // half a circle of 5 mm
}

}  // namespace
}  // namespace stratum::motion

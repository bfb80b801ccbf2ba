#include "gcode/machine/carriages.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

TEST(Carriages, ACopyStandsBeside) {
    const Toolpath toolpath =
        readProgram("M83\nM605 S2 X100\nG1 X5 Z.2\nG1 X9 E1\nG3 X9 Y2 I0 J1 E1\nM605 S1\nG1 X20 E1\n");
    ASSERT_EQ(toolpath.beads.size(), 5U);
    EXPECT_EQ(toolpath.beads[1].x0, 105);
    EXPECT_EQ(toolpath.beads[1].x1, 109);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[0]).tool, 0);
    EXPECT_EQ(toolpath.runOf(toolpath.beads[1]).tool, 1);
    EXPECT_EQ(toolpath.arcs.at(1).center_x, 109);
    EXPECT_EQ(toolpath.arcs.at(1).sweep, toolpath.arcs.at(0).sweep);
    EXPECT_NEAR(toolpath.filament_mm, 5, 1e-9);
    EXPECT_EQ(toolpath.filament_by_tool, (std::vector<double>{3, 2}));
    EXPECT_NEAR(beadVolume(toolpath), toolpath.extruded_mm3, 1e-4);
    EXPECT_TRUE(toolpath.warnings.empty());
}

TEST(Carriages, AMirrorImageGoesTheOtherWay) {
    const Toolpath toolpath = readProgram("M83\nG1 X10 Z.2\nM605 S2 X100\nM605 S3\nG1 X12 E1\nG3 X12 Y2 I0 J1 E1\n");
    ASSERT_EQ(toolpath.beads.size(), 4U);
    EXPECT_EQ(toolpath.beads[1].x0, 110);  // both stood 100 mm apart when the mode began
    EXPECT_EQ(toolpath.beads[1].x1, 108);
    EXPECT_EQ(toolpath.arcs.at(1).center_x, 108);
    EXPECT_EQ(toolpath.arcs.at(1).sweep, -toolpath.arcs.at(0).sweep);
}

TEST(Carriages, ADistanceThatIsNotInTheFileIsSaid) {
    for (const auto* mode :
         {"M605 S2", "M605 S2 X-5", "M605 S2 X0", "M605 S2 X1000000", "M605 S3", "M605 S5", "M605 S6",
          "SET_DUAL_CARRIAGE CARRIAGE=1 MODE=COPY", "SET_DUAL_CARRIAGE CARRIAGE=1 MODE=mirror"}) {
        const Toolpath toolpath = readProgram(std::string(mode) + "\nM83\nG1 Z.2\nG1 X9 E1\n");
        EXPECT_EQ(toolpath.beads.size(), 1U) << mode;
        EXPECT_EQ(warningCount(toolpath, "how far from the first is not in the file"), 1U) << mode;
    }
    for (const auto* mode : {"M605 S0", "M605 S1", "M605", "SET_DUAL_CARRIAGE CARRIAGE=0"})
        EXPECT_TRUE(readProgram(std::string(mode) + "\nM83\nG1 Z.2\nG1 X9 E1\n").warnings.empty()) << mode;
}

TEST(Carriages, APlannedTimeIsTheFirstNozzles) {
    struct Sink : MotionSink {
        void limits(const MachineLimits&) override {}
        void move(const Move& move) override {
            if (move.bead != Move::kNoBead) beads.push_back(move.bead);
        }
        void wait(double) override {}
        std::vector<std::uint32_t> beads;
    } sink;
    ReadOptions options;
    options.motion = &sink;
    readProgram("M83\nM605 S2 X100\nG1 Z.2\nG1 X9 E1\nG1 X0 E1\n", options);
    EXPECT_EQ(sink.beads, (std::vector<std::uint32_t>{0, 2}));
}

}  // namespace
}  // namespace stratum::gcode

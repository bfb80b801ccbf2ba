#include "study/deposit/made_programs.h"

#include "deposit/read_print.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum::study {
namespace {

gcode::Toolpath readMade(const std::string& program) { return deposit::readPrint(program, "made", {}, false).toolpath; }

TEST(MadePrograms, TheTileIsThatOfTheDocuments) {
    for (const bool crossed : {false, true}) {
        const gcode::Toolpath tile = readMade(tileProgram(crossed));
        ASSERT_EQ(tile.beads.size(), 24U);
        EXPECT_NEAR(gcode::beadVolume(tile), 19.540, 5e-4);  // as bench/volco.py says
        EXPECT_NEAR(gcode::beadVolume(tile), tileFed(), 1e-4);
        for (const gcode::Bead& bead : tile.beads) {
            EXPECT_NEAR(static_cast<double>(bead.width), 0.45, 1e-5);
            EXPECT_NEAR(static_cast<double>(tile.runOf(bead).height), 0.2, 1e-6);
        }
        const gcode::Bead& last = tile.beads.back();
        EXPECT_NEAR(std::abs(last.x1 - last.x0), crossed ? 0 : 10, 1e-6);
    }
}

TEST(MadePrograms, WallsHaveTheirLayersAndTheirFlow) {
    const gcode::Toolpath wall = readMade(wallProgram(0.15, 0.45, 1.1, 10));
    EXPECT_EQ(wall.layer_count, 10U);
    EXPECT_NEAR(gcode::beadVolume(wall), 1.1 * gcode::sectionArea(0.45, 0.15) * 8 * 10, 1e-4);
    EXPECT_GT(wall.beads.front().width, 0.48F);
    EXPECT_EQ(wall.runOf(wall.beads.front()).feature, gcode::Feature::external_perimeter);
}

TEST(MadePrograms, TheCornerIsOneOfNinetyDegrees) {
    const gcode::Toolpath corner = readMade(cornerProgram(8));
    ASSERT_EQ(corner.beads.size(), 2U);
    EXPECT_DOUBLE_EQ(corner.beads[0].x1, kCornerAt);
    EXPECT_DOUBLE_EQ(corner.beads[1].y1, kCornerAt + 30);
    EXPECT_NEAR(static_cast<double>(corner.beads[0].width), kCornerWidth, 1e-5);
}

}  // namespace
}  // namespace stratum::study

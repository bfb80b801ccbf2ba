#include "view/beads/move_stream.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace stratum::view {
namespace {

std::vector<MoveRecord> recordsOf(const std::string& program, gcode::ReadOptions options = {}) {
    return movesOf(program, "test.gcode", options, gcode::readToolpath(program, "test.gcode", options));
}

MoveKind kindOf(const MoveRecord& record) { return static_cast<MoveKind>(record.line >> 28 & 7); }

const char* const kProgram =
    "M83\n"
    "G1 X10 Y10 Z0.2 F6000\n"     // 2: travel
    ";TYPE:External perimeter\n"  //
    "G1 X20 E1\n"                 // 4: seam, bead 0
    ";TYPE:Overhang perimeter\n"  //
    "G1 Y20 E1\n"                 // 6: bead 1
    ";TYPE:External perimeter\n"  //
    "G1 X10 E1\n"                 // 8: bead 2, of the same line
    "G1 X11 E-0.5\n"              // 9: wipe
    "G1 E-0.5\n"                  // 10: retraction
    "T1\n"                        // 11: tool change
    "G1 Z0.6\n"                   // 12: travel
    "M601\n"                      // 13: pause
    "G1 E1\n"                     // 14: recovery
    "G1 X20 E1\n"                 // 15: seam, bead 3
    "M600\n"                      // 16
    "G1 X0 Y0\n";                 // 17: travel behind the last bead

TEST(MoveTable, HasEachMoveWithItsPlace) {
    const auto records = recordsOf(kProgram);
    const std::vector<MoveKind> kinds{MoveKind::travel,          MoveKind::seam,        MoveKind::wipe,
                                      MoveKind::retraction,      MoveKind::tool_change, MoveKind::travel,
                                      MoveKind::pause,           MoveKind::recovery,    MoveKind::seam,
                                      MoveKind::filament_change, MoveKind::travel};
    const std::vector<std::uint32_t> lines{2, 4, 9, 10, 11, 12, 13, 14, 15, 16, 17};
    const std::vector<std::uint32_t> beads{0, 0, 3, 3, 3, 3, 3, 3, 3, 4, 4};
    ASSERT_EQ(records.size(), kinds.size());
    for (std::size_t n = 0; n < records.size(); ++n) {
        SCOPED_TRACE(n);
        EXPECT_EQ(kindOf(records[n]), kinds[n]);
        EXPECT_EQ(records[n].line & 0xfffffff, lines[n]);
        EXPECT_EQ(records[n].bead, beads[n]);
    }
    EXPECT_EQ(records[0].x1, 10.0F);
    EXPECT_EQ(records[1].x0, 10.0F);  // where the bead begins
    EXPECT_EQ(records[2].x1, 11.0F);
    EXPECT_EQ(records[4].x0, 11.0F);  // where the nozzle is
    EXPECT_EQ(records[5].z1, 0.6F);
}

// A spiral in the air is one move of several lines, which follow the circle.
TEST(MoveTable, FollowsArcs) {
    const auto records = recordsOf("M83\nG1 X10 E1\nG17\nG3 Z0.6 I5 J0\nG1 X20 E1\n");
    std::size_t begun = 0;
    for (const MoveRecord& record : records) {
        begun += record.line >> 31 == 0 ? 1 : 0;
        EXPECT_NEAR(std::hypot(record.x1 - 15.0F, record.y1), 5.0F, 1e-4F);
    }
    EXPECT_EQ(begun, 1U);
    ASSERT_EQ(records.size(), 32U);
    EXPECT_NEAR(records.back().z1, 0.6F, 1e-6F);
    EXPECT_EQ(records[4].x0, records[3].x1);
}

TEST(MoveTable, FirmwareRetractionsHaveAPlace) {
    const auto records = recordsOf("M83\nM207 S2 F1800\nG1 X10 E1\nG10\nG1 X20\nG11\nG1 X30 E1\n");
    ASSERT_EQ(records.size(), 3U);
    EXPECT_EQ(kindOf(records[0]), MoveKind::retraction);
    EXPECT_EQ(records[0].x0, 10.0F);
    EXPECT_EQ(kindOf(records[2]), MoveKind::recovery);
    EXPECT_EQ(records[2].x0, 20.0F);
}

TEST(MoveTable, SaysWhyThereIsNone) {
    gcode::ReadOptions belt;
    belt.belt_angle = 45;
    EXPECT_THROW((void)recordsOf("M83\nG1 X10 Z.2 E1\n", belt), InputError);
    const std::string program = "M83\nG1 X10 E1\n";
    EXPECT_THROW((void)movesOf(program, "other.gcode", {}, gcode::readToolpath(program + "G1 X20 E1\n", "", {})),
                 InputError);
}

}  // namespace
}  // namespace stratum::view

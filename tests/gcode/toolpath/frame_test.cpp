#include "gcode/toolpath/frame.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

TEST(Frame, BeforeTheFirstBeadG92MovesPrintSpace) {
    Frame frame(0);
    frame.moveTo({5, 0, 10});
    frame.setG92Position(2, 0.2);
    EXPECT_EQ(frame.position().z, 0.2);
    EXPECT_EQ(frame.offset().z, 0);
    frame.clearG92Offsets();
    EXPECT_NEAR(frame.position().z, 10, 1e-12);
}

TEST(Frame, AfterTheFirstBeadG92MovesTheProgram) {
    Frame frame(0);
    frame.freezePrintSpace();
    frame.moveTo({30, 0, 0});
    frame.setG92Position(0, 0);
    EXPECT_EQ(frame.position().x, 30);
    EXPECT_EQ(frame.offset().x, 30);
    EXPECT_EQ(frame.program(0), 0);
    frame.suspendG92Offsets();
    EXPECT_EQ(frame.program(0), 30);
    frame.resumeG92Offsets();
    EXPECT_EQ(frame.program(0), 0);
}

TEST(Frame, HomingTakesPrintSpaceAlong) {
    Frame frame(0);
    frame.moveTo({7, 8, 0});
    frame.freezePrintSpace();
    frame.setG92Position(0, 0);
    frame.home(0);
    EXPECT_EQ(frame.position().x, 0);
    EXPECT_EQ(frame.offset().x, 0);
    EXPECT_EQ(frame.position().y, 8);
}

TEST(Frame, WorkspacesKeepTheirOffsets) {
    Frame frame(1);
    frame.freezePrintSpace();
    frame.moveTo({10, 0, 0});
    frame.select(2);
    frame.setG92Position(0, 0);
    frame.select(1);
    EXPECT_EQ(frame.program(0), 10);
    frame.select(2);
    EXPECT_EQ(frame.program(0), 0);
    frame.setWorkspaceOrigin(3, 0, 4);
    frame.select(3);
    EXPECT_EQ(frame.program(0), 6);
    frame.setWorkspacePosition(1, 0, -1);
    frame.select(1);
    EXPECT_EQ(frame.program(0), -1);
    EXPECT_EQ(frame.position().x, 10);  // the nozzle has not moved
}

TEST(Frame, TheMachinesOwnWorkspaceResets) {
    Frame frame(0);
    frame.freezePrintSpace();
    frame.setG92Position(0, 5);
    frame.select(1);
    frame.select(0);
    EXPECT_EQ(frame.program(0), 0);
}

TEST(Frame, HomeOffsetsHoldInAllWorkspacesAndAfterHoming) {
    Frame frame(0);
    frame.freezePrintSpace();
    frame.setHomeOffset(2, -0.1);
    EXPECT_DOUBLE_EQ(frame.program(2), -0.1);
    frame.select(4);
    EXPECT_DOUBLE_EQ(frame.program(2), -0.1);
    frame.home(2);
    EXPECT_DOUBLE_EQ(frame.program(2), -0.1);
}

TEST(Frame, ToolOffsetsMoveTheNozzleNotTheProgram) {
    Frame frame(0);
    frame.moveTo({10, 0, 0});
    frame.setToolOffset({18, 0, 0});
    EXPECT_EQ(frame.program(0), 10);
    EXPECT_EQ(frame.position().x, 28);
    frame.setG92Position(0, 1);
    EXPECT_EQ(frame.program(0), 1);
    frame.home(0);
    EXPECT_EQ(frame.position().x, 18);
}

}  // namespace
}  // namespace stratum::gcode
